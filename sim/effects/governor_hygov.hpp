#pragma once
// HYGOV: hydro turbine with an inelastic water column and a governor with temporary droop.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_hygov {

/// Lower bound of the gate's opening, a leakage [pu]: head = (flow/gate)^2 is undefined for gate = 0.
constexpr double kLeak = 0.01;

struct Model {
  static constexpr std::string_view name = "HYGOV", title = "hydro turbine and governor",
                                    source = "IEEE PES-TR1 (2013), 4.2; PSS/E HYGOV; Kundur (1994), 9.1",
                                    dyr_name = "HYGOV";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view description = R"(
                                  VELM, GMAX
  nref + R dPref - b(w) --> (+) --> [ 1/(1 + s Tf) ] --e--> [ (1 + s Tr)/(r Tr s) ] --c--> [ 1/(1 + s Tg) ] --> g
                             -R c                     -VELM, GMIN
  b(w): 0 within +-db, beyond it w minus the nearer edge (HYGOVD; db = 0 is HYGOV)
  Tf de/dt = nref + R dPref - b(w) - R c - e
  r dc/dt = e/Tr + de/dt     -VELM <= dc/dt <= VELM, GMIN <= c <= GMAX, both without wind-up
  Tg dg/dt = c - g           g: gate opening, in h at least 0.01 (a shut gate leaks)
  TW dq/dt = 1 - h           h = (q/g)^2
  Pm = At h (q - qNL) - Dturb w g
)";
  enum P { R, r, Tr, Tf, Tg, VELM, GMAX, GMIN, TW, At, Dturb, qNL, db };
  static constexpr Source defaults_from = literature::cim("GovHydro1");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"R", "R", "pu", 0.05, 0.0, 1.0, kNoNullValue, "permanent droop",
       literature::psid("HYGOV/ThreeBus_HYGOV.dyr")},
      {"r", "r", "pu", 0.3, 0.01, 5.0, kNoNullValue, "temporary droop"},
      {"Tr", "Tr", "s", 5.0, 0.1, 60.0, kNoNullValue, "governor (dashpot) time constant"},
      {"Tf", "Tf", "s", 0.05, 0.005, 5.0, kNoNullValue, "filter time constant"},
      {"Tg", "Tg", "s", 0.5, 0.01, 50.0, kNoNullValue, "servo time constant"},
      {"VELM", "VELM", "pu/s", 0.2, 0.001, 10.0, kNoNullValue, "gate velocity limit"},
      upper_limit({"GMAX", "GMAX", "pu", 1.0, 0.1, 2.0, kNoNullValue, "upper limit of the gate"}),
      lower_limit({"GMIN", "GMIN", "pu", 0.0, 0.0, 1.0, kNoNullValue, "lower limit of the gate"}),
      {"TW", "TW", "s", 1.0, 0.05, 30.0, kNoNullValue, "water starting time"},
      {"At", "At", "pu", 1.2, 0.3, 5.0, kNoNullValue, "turbine gain"},
      {"Dturb", "Dturb", "pu", 0.0, 0.0, 5.0, 0.0, "turbine damping, power per speed at full gate",
       literature::psid("HYGOV/ThreeBus_HYGOV.dyr")},
      {"qNL", "qNL", "pu", 0.08, 0.0, 0.5, kNoNullValue, "flow at no load"},
      {"db", "db", "pu", 0.0, 0.0, 0.02, 0.0, "half width of the intentional dead-band of the speed",
       shared::kNothing, shared::kDeadBand}};
  static constexpr int dyr_columns[] = {R, r, Tr, Tf, Tg, VELM, GMAX, GMIN, TW, At, Dturb, qNL};
  enum C { droop, ir, iTr, iTf, iTg, rate, high, low, iTW, gain, damping, idle, band, nref, coefficients };
  enum X { filter, desired, gate, flow };
  static constexpr State states[] = {{"filter", "pu", "filtered speed error"},
                                     {"desired", "pu", "desired gate", 1.0, low, high},
                                     {"gate", "pu", "gate opening"},
                                     {"flow", "pu", "water flow"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_positive({r, Tr, Tf, Tg, VELM, TW, At},
                            "HYGOV divides by it, or its output could not change");
    values.refuse(!(p[GMAX] > p[GMIN] && p[GMIN] >= 0), values.text(GMAX, GMIN),
                  "the range of the gate must not be empty or negative", "give GMAX > GMIN >= 0");
    values.refuse_negative({db}, "a width cannot be negative");
  }
  static std::string_view unphysical(const double* p) { return p[r] > p[R] ? "" : "r > R"; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[droop] = p[R];
    c[ir] = T(1.0) / p[r];
    c[iTr] = T(1.0) / p[Tr];
    c[iTf] = T(1.0) / p[Tf];
    c[iTg] = T(1.0) / p[Tg];
    c[rate] = p[VELM];
    c[high] = p[GMAX];
    c[low] = p[GMIN];
    c[iTW] = T(1.0) / p[TW];
    c[gain] = p[At];
    c[damping] = p[Dturb];
    c[idle] = p[qNL];
    c[band] = p[db];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T wanted = clamp(x[desired], c[low], c[high]);
    const T error = c[nref] + s.dGref - dead_band(s.speed, c[band]) + c[droop] * (s.dPref - wanted);
    dx[filter] = (error - x[filter]) * c[iTf];
    dx[desired] = clamp((x[filter] * c[iTr] + dx[filter]) * c[ir], T(0.0) - c[rate], c[rate]);
    dx[gate] = (wanted - x[gate]) * c[iTg];
    const T opening = select(x[gate] > T(kLeak), x[gate], T(kLeak));
    const T head = square(x[flow] / opening);
    dx[flow] = (T(1.0) - head) * c[iTW];
    s.Tm = c[gain] * head * (x[flow] - c[idle]) - c[damping] * s.speed * x[gate];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    x[flow] = s.Tm / p[At] + p[qNL];
    if (value_of(x[flow]) < kLeak)
      return fmt::format("the operating point needs a gate of {:.4g} pu, but a gate below {:g} pu is shut",
                         value_of(x[flow]), kLeak);
    x[gate] = x[desired] = x[flow];
    x[filter] = T(0.0);
    c[nref] = p[R] * x[desired];
    return {};
  }
};

}  // namespace swingbank::sim::effects::governor_hygov
