#pragma once
// IEEEG3: hydro turbine with a linear water column, and a dashpot governor with a pilot valve.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_ieeeg3 {

struct Model {
  static constexpr std::string_view
      name = "IEEEG3",
      title = "hydro turbine and dashpot governor of 1973",
      source =
          "IEEE Trans. PAS-92 (1973) 1904; CIM GovHydroIEEE2; blocks and order of the columns: STEPS "
          "(github.com/changgang/steps), IEEEG3; PSS/E IEEEG3",
      dyr_name = "IEEEG3";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view variant_of = "HYGOV";
  static constexpr std::string_view description = R"(
                                               UO         PMAX
  sigma (ref + dPref - g) - w - back --> [ 1/TG/(1 + s TP) ]--> [ 1/s ] --> g         back = delta TR s/(1 + s TR) g
                                               UC         PMIN      velocity and gate, both without wind-up
  g --> [ a23 (1 + (a11 - a13 a21/a23) s TW)/(1 + a11 s TW) ] --> Pm
)";
  enum P { TG, TP, UO, UC, PMAX, PMIN, SIGMA, DELTA, TR, TW, A11, A13, A21, A23 };
  static constexpr Source defaults_from = literature::cim("GovHydroIEEE2");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Source kLossless = literature::kundur("9.1.1: an ideal turbine at rated load");
  static constexpr Parameter parameters[] = {
      {"TG", "TG", "s", 0.5, 0.001, 50.0, kNoNullValue, "gate servo"},
      {"TP", "TP", "s", 0.03, 0.0, 10.0, 0.0, "pilot valve (0: none)"},
      {"UO", "UO", "pu/s", 0.1, 0.001, 10.0, kNoNullValue, "fastest opening"},
      {"UC", "UC", "pu/s", -0.1, -10.0, -0.001, kNoNullValue, "fastest closing, negative"},
      upper_limit({"PMAX", "PMAX", "pu", 1.0, 0.1, 5.0, kNoNullValue, "upper limit of the gate"}),
      lower_limit({"PMIN", "PMIN", "pu", 0.0, -1.0, 1.0, kNoNullValue, "lower limit of the gate"}),
      {"SIGMA", "sigma", "pu", 0.05, 0.0, 1.0, kNoNullValue, "permanent droop"},
      {"DELTA", "delta", "pu", 0.5, 0.0, 5.0, 0.0, "temporary droop"},
      {"TR", "TR", "s", 12.0, 0.0, 100.0, kNoNullValue, "dashpot time constant (0: no temporary droop)"},
      {"TW", "TW", "s", 2.0, 0.0, 30.0, 0.0, "water starting time"},
      {"A11", "a11", "-", 0.5, 0.0, 5.0, kNoNullValue, "change of flow per change of head", kLossless},
      {"A13", "a13", "-", 1.0, 0.0, 5.0, kNoNullValue, "change of flow per change of gate", kLossless},
      {"A21", "a21", "-", 1.5, 0.0, 5.0, kNoNullValue, "change of power per change of head", kLossless},
      {"A23", "a23", "-", 1.0, 0.01, 5.0, kNoNullValue, "change of power per change of gate", kLossless}};
  static constexpr int dyr_columns[] = {TG, TP, UO, UC, PMAX, PMIN, SIGMA, DELTA, TR, TW, A11, A13, A21, A23};
  enum C {
    iTG,
    iTP,
    opening,
    closing,
    high,
    low,
    droop,
    temporary,
    iTR,
    gain,
    water_lead,
    water_lag,
    ref,
    coefficients
  };
  enum X { velocity, gate, dashpot, water };
  static constexpr State states[] = {
      {"velocity", "pu/s", "pilot valve's velocity", 1.0, closing, opening, {iTP}},
      {.name = "gate", .unit = "pu", .meaning = "gate opening", .low = low, .high = high, .bends = true},
      {"dashpot", "pu", "gate, lagged by the dashpot", 1.0, -1, -1, {iTR}},
      {"water", "pu", "state of the water column", 1.0, -1, -1, {water_lag}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_divisors({TG, A23});
    values.refuse_negative({TP, SIGMA, DELTA, TR, TW}, "droops and times cannot be negative");
    values.refuse(!(p[UO] > 0 && p[UC] < 0), values.text(UO, UC),
                  "the gate must be able to open and to close", "give UO > 0 and UC < 0");
    values.require_above(PMAX, PMIN, "the range of the gate must not be empty");
    values.refuse(!(p[A11] >= 0) || (p[TW] > 0 && p[A11] == 0 && p[A13] * p[A21] != 0),
                  values.text(A11, A13, A21), "the water column would have a lead without a lag",
                  "give a11 > 0, or TW = 0 for no water column");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[iTG] = T(1.0) / p[TG];
    c[iTP] = inverse(p[TP]);
    c[opening] = p[UO];
    c[closing] = p[UC];
    c[high] = p[PMAX];
    c[low] = p[PMIN];
    c[droop] = p[SIGMA];
    c[temporary] = p[DELTA];
    c[iTR] = inverse(p[TR]);
    c[gain] = p[A23];
    c[water_lead] = (p[A11] - p[A13] * p[A21] / p[A23]) * p[TW];
    c[water_lag] = inverse(p[A11] * p[TW]);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T open = clamp(x[gate], c[low], c[high]);
    const T back = c[temporary] * washout(c[iTR], x[dashpot], open, dx[dashpot]);
    const T asked = (c[droop] * (c[ref] + s.dPref - open) + s.dGref - s.speed - back) * c[iTG];
    dx[gate] = clamp(lag(c[iTP], x[velocity], asked, dx[velocity]), c[closing], c[opening]);
    s.Tm = lead_lag(c[water_lead], c[water_lag], x[water], c[gain] * open, dx[water]);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    x[velocity] = T(0.0);
    x[water] = s.Tm;
    x[gate] = x[dashpot] = c[ref] = s.Tm / p[A23];
    return {};
  }
};

}  // namespace swingbank::sim::effects::governor_ieeeg3
