#pragma once
// IEEEG2: hydro turbine with a governor of one lag and one lead-lag.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_ieeeg2 {

struct Model {
  static constexpr std::string_view
      name = "IEEEG2",
      title = "hydro turbine and governor of 1973, simplified",
      source =
          "IEEE Trans. PAS-92 (1973) 1904; CIM GovHydroIEEE0; order of the columns: STEPS "
          "(github.com/changgang/steps), IEEEG2; PSS/E IEEEG2",
      dyr_name = "IEEEG2";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view variant_of = "HYGOV";
  static constexpr std::string_view description = R"(
  w --> [ K/(1 + s T1) ] --> [ (1 + s T2)/(1 + s T3) ] --(-)--> gate --> [ (1 - s T4)/(1 + s T4/2) ] --> Pm
                                          Pref + dPref --(+)     gate: PMIN to PMAX
)";
  enum P { K, T1, T2, T3, PMAX, PMIN, T4 };
  /// CIM's values are those of a steam turbine's governor and would be unstable with a water column.
  static constexpr Source defaults_from =
      literature::own("a dashpot of 5 s: T2 = TR, T1 = TR delta/sigma, droops of 5 and 50 %");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"K", "K", "pu", 20.0, 0.0, 200.0, 0.0, "gain, the reciprocal of droop",
       literature::own("a droop of 5 %; CIM has no default")},
      {"T1", "T1", "s", 50.0, 0.0, 500.0, kNoNullValue, "lag of the governor (0: none)"},
      {"T2", "T2", "s", 5.0, 0.0, 100.0, kNoNullValue, "lead of the governor"},
      {"T3", "T3", "s", 0.5, 0.0, 100.0, kNoNullValue, "gate actuator (0: bypass)"},
      upper_limit({"PMAX", "PMAX", "pu", 1.0, 0.1, 5.0, kNoNullValue, "upper limit of the gate",
                   literature::own("rated power; CIM has no default")}),
      lower_limit({"PMIN", "PMIN", "pu", 0.0, -1.0, 1.0, kNoNullValue, "lower limit of the gate",
                   literature::own("shut; CIM has no default")}),
      {"T4", "T4", "s", 1.0, 0.0, 30.0, 0.0, "water starting time", literature::cim("GovHydro1, Tw")}};
  static constexpr int dyr_columns[] = {K, T1, T2, T3, PMAX, PMIN, T4};
  enum C { gain, iT1, lead, iT3, high, low, water_lead, water_lag, Pref, coefficients };
  enum X { governor, actuator, water };
  static constexpr State states[] = {{"governor", "pu", "lagged speed", 1.0, -1, -1, {iT1}},
                                     {"actuator", "pu", "state of the actuator", 1.0, -1, -1, {iT3}},
                                     {.name = "water",
                                      .unit = "pu",
                                      .meaning = "state of the water column",
                                      .moved_by = {water_lag},
                                      .bends = true}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.refuse_negative({K, T1, T2, T3, T4}, "gains and times cannot be negative");
    values.require_above(PMAX, PMIN, "the range of the gate must not be empty");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[gain] = p[K];
    c[iT1] = inverse(p[T1]);
    c[lead] = p[T2];
    c[iT3] = inverse(p[T3]);
    c[high] = p[PMAX];
    c[low] = p[PMIN];
    c[water_lead] = T(0.0) - p[T4];
    c[water_lag] = inverse(T(0.5) * p[T4]);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T droop = lag(c[iT1], x[governor], c[gain] * s.speed, dx[governor]);
    const T asked = c[Pref] + s.dPref + s.dGref - lead_lag(c[lead], c[iT3], x[actuator], droop, dx[actuator]);
    s.Tm = lead_lag(c[water_lead], c[water_lag], x[water], clamp(asked, c[low], c[high]), dx[water]);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    if (auto why = shared::outside("gate", s.Tm, c[low], c[high], "PMIN, PMAX"); !why.empty()) return why;
    x[governor] = x[actuator] = T(0.0);
    x[water] = c[Pref] = s.Tm;
    return {};
  }
};

}  // namespace swingbank::sim::effects::governor_ieeeg2
