#pragma once
// GAST: single-shaft gas turbine with exhaust-temperature limit.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_gast {

struct Model {
  static constexpr std::string_view name = "GAST", title = "gas turbine and governor, temperature limit",
                                    source = "IEEE PES-TR1 (2013), 3.1; PSS/E GAST", dyr_name = "GAST";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view description = R"(
                                    VMAX
  Pref + dPref - b(w)/R --> [ min ] --> [ 1/(1 + s T1) ] --fuel--> [ 1/(1 + s T2) ] --flow--> (+) --> Pm
  AT + KT (AT - exhaust) -->        VMIN, non-windup                                         -Dturb w
  flow --> [ 1/(1 + s T3) ] --exhaust
  b(w): 0 within +-db, beyond it w minus the nearer edge (GASTD; db = 0 is GAST)
  T1 dfuel/dt = min(Pref + dPref - b(w)/R, AT + KT (AT - exhaust)) - fuel      VMIN <= fuel <= VMAX
  T2 dflow/dt = fuel - flow      T3 dexhaust/dt = flow - exhaust      Pm = flow - Dturb w
)";
  enum P { R, T1, T2, T3, AT, KT, VMAX, VMIN, Dturb, db };
  static constexpr Source defaults_from = literature::gridpack("240busWECC_2018_PSS_mod.dyr");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"R", "R", "pu", 0.05, 0.005, 1.0, kNoNullValue, "permanent droop",
       literature::psid("GAST/ThreeBus_GAST.dyr")},
      {"T1", "T1", "s", 0.4, 0.01, 10.0, kNoNullValue, "fuel valve time constant",
       literature::own("among the case files' 0.2 to 0.5 s")},
      {"T2", "T2", "s", 0.1, 0.0, 10.0, kNoNullValue, "combustion chamber time constant (0: none)",
       literature::own("faster than the case files' 0.2 to 0.5 s")},
      {"T3", "T3", "s", 3.0, 0.0, 30.0, kNoNullValue, "exhaust temperature measurement (0: none)"},
      upper_limit({"AT", "AT", "pu", 1.0, 0.1, 5.0, kNoNullValue, "ambient temperature load limit"}),
      {"KT", "KT", "pu", 2.0, 0.0, 20.0, kNoNullValue, "gain of the temperature limit"},
      upper_limit({"VMAX", "VMAX", "pu", 1.1, 0.1, 5.0, kNoNullValue, "upper limit of the fuel valve",
                   literature::psid("GAST/ThreeBus_GAST.dyr")}),
      lower_limit({"VMIN", "VMIN", "pu", -0.05, -1.0, 1.0, kNoNullValue, "lower limit of the fuel valve",
                   literature::own("a little below no load; the case files have 0")}),
      {"Dturb", "Dturb", "pu", 0.0, 0.0, 5.0, 0.0, "turbine damping, power per speed"},
      {"db", "db", "pu", 0.0, 0.0, 0.02, 0.0, "half width of the intentional dead-band of the speed",
       shared::kNothing, shared::kDeadBand}};
  static constexpr int dyr_columns[] = {R, T1, T2, T3, AT, KT, VMAX, VMIN, Dturb};
  enum C { iR, iT1, iT2, iT3, ambient, gain, high, low, damping, band, Pref, coefficients };
  enum X { fuel, flow, exhaust };
  static constexpr State states[] = {{"fuel", "pu", "fuel valve", 1.0, low, high},
                                     {"flow", "pu", "gas flow"},
                                     {"exhaust", "pu", "measured exhaust temperature, as load"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_divisors({R, T1});
    values.require_times({T2, T3});
    values.require_above(VMAX, VMIN, "the range of the valve must not be empty");
    values.refuse_negative({KT}, "a hotter exhaust must lower the limit");
    values.refuse_negative({db}, "a width cannot be negative");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[iR] = T(1.0) / p[R];
    c[iT1] = T(1.0) / p[T1];
    c[iT2] = inverse(p[T2]);
    c[iT3] = inverse(p[T3]);
    c[ambient] = p[AT];
    c[gain] = p[KT];
    c[high] = p[VMAX];
    c[low] = p[VMIN];
    c[damping] = p[Dturb];
    c[band] = p[db];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T valve = clamp(x[fuel], c[low], c[high]);
    const T gas = lag(c[iT2], x[flow], valve, dx[flow]);
    const T heat = lag(c[iT3], x[exhaust], gas, dx[exhaust]);
    const T demand = c[Pref] + s.dPref + s.dGref - dead_band(s.speed, c[band]) * c[iR];
    const T limit = c[ambient] + c[gain] * (c[ambient] - heat);
    dx[fuel] = (select(demand < limit, demand, limit) - valve) * c[iT1];
    s.Tm = gas - c[damping] * s.speed;
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    // Rounding of the power flow may put a dispatch above the limit; the limit is then raised to the
    // dispatch.
    constexpr double kLimitRounding = 1e-9;
    c[ambient] = select(p[AT] < s.Tm, s.Tm, p[AT]);
    if (value_of(s.Tm) > value_of(p[AT]) + kLimitRounding)
      return fmt::format(
          "the operating point needs {:.4g} pu of power, above the temperature limit AT = {:.4g} pu",
          value_of(s.Tm), value_of(p[AT]));
    x[fuel] = x[flow] = x[exhaust] = c[Pref] = s.Tm;
    return {};
  }
};

}  // namespace swingbank::sim::effects::governor_gast
