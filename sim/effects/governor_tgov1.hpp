#pragma once
// TGOV1: steam turbine with one reheater, and governor with droop.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_tgov1 {

struct Model {
  static constexpr std::string_view name = "TGOV1", title = "steam turbine and governor",
                                    source = "IEEE PES-TR1 (2013), 2.2; PSS/E TGOV1", dyr_name = "TGOV1";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view description = R"(
                          VMAX
  Pref + dPref - b(w)/R --> [ 1/(1 + s T1) ] --valve--> [ (1 + s T2)/(1 + s T3) ] --> (+) --> Pm
                          VMIN, non-windup                                            -Dt w
  b(w): 0 within +-db, beyond it w minus the nearer edge (TGOV1D; db = 0 is TGOV1)
  T1 dvalve/dt = Pref + dPref - b(w)/R - valve        VMIN <= valve <= VMAX
  T3 dx/dt = valve - x        Pm = x + (T2/T3)(valve - x) - Dt w
)";
  enum P { R, T1, VMAX, VMIN, T2, T3, Dt, db };
  static constexpr Source defaults_from = literature::cim("GovSteam0");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"R", "R", "pu", 0.05, 0.005, 1.0, kNoNullValue, "permanent droop"},
      {"T1", "T1", "s", 0.5, 0.0, 10.0, kNoNullValue, "steam bowl time constant (0: none)"},
      upper_limit({"VMAX", "VMAX", "pu", 1.0, 0.1, 5.0, kNoNullValue, "upper limit of the valve"}),
      lower_limit({"VMIN", "VMIN", "pu", 0.0, -1.0, 1.0, kNoNullValue, "lower limit of the valve", kAsEffect,
                   literature::own(
                       "no turbine brakes with more than its rating; dynamicsWECC.dyr (GridDyn) has -1.5")}),
      {"T2", "T2", "s", 2.0, 0.0, 30.0, kNoNullValue, "lead; T2/T3 is the high-pressure share of power",
       literature::own("a high-pressure share of 2/7; CIM has 3 of 10 s")},
      {"T3", "T3", "s", 7.0, 0.0, 60.0, kNoNullValue, "reheater time constant (0: none)",
       literature::own("shorter than CIM's 10 s")},
      {"Dt", "Dt", "pu", 0.0, 0.0, 5.0, 0.0, "turbine damping, power per speed"},
      {"db", "db", "pu", 0.0, 0.0, 0.02, 0.0, "half width of the intentional dead-band of the speed",
       shared::kNothing, shared::kDeadBand}};
  static constexpr int dyr_columns[] = {R, T1, VMAX, VMIN, T2, T3, Dt};
  enum C { iR, iT1, high, low, lead, iT3, damping, band, Pref, coefficients };
  enum X { valve, reheat };
  static constexpr State states[] = {{"valve", "pu", "valve opening", 1.0, low, high},
                                     {"reheat", "pu", "state of the reheater"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_divisors({R});
    values.require_times({T1, T2, T3});
    values.require_above(VMAX, VMIN, "the range of the valve must not be empty");
    values.refuse_negative({db}, "a width cannot be negative");
  }
  static std::string_view unphysical(const double* p) { return p[T3] >= p[T2] ? "" : "T3 >= T2"; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[iR] = T(1.0) / p[R];
    c[iT1] = inverse(p[T1]);
    c[high] = p[VMAX];
    c[low] = p[VMIN];
    c[lead] = p[T2];
    c[iT3] = inverse(p[T3]);
    c[damping] = p[Dt];
    c[band] = p[db];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T demand = c[Pref] + s.dPref + (s.dGref - dead_band(s.speed, c[band])) * c[iR];
    const T opening = clamp(lag(c[iT1], x[valve], demand, dx[valve]), c[low], c[high]);
    s.Tm = lead_lag(c[lead], c[iT3], x[reheat], opening, dx[reheat]) - c[damping] * s.speed;
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    x[valve] = x[reheat] = c[Pref] = s.Tm;
    return {};
  }
};

}  // namespace swingbank::sim::effects::governor_tgov1
