#pragma once
// IEESGO: IEEE standard steam or hydro governor of 1973, three lags with power fractions.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_ieesgo {

struct Model {
  static constexpr std::string_view name = "IEESGO", title = "general turbine and governor of 1973",
                                    source =
                                        "IEEE Committee Report, Dynamic models for steam and hydro turbines, "
                                        "IEEE Trans. PAS-92 (1973) 1904; PSS/E IEESGO",
                                    dyr_name = "IEESGO";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view variant_of = "IEEEG1";
  static constexpr std::string_view description = R"(
  b(w) --> [ K1/(1 + s T1) ] --> [ (1 + s T2)/(1 + s T3) ] --(-)--> [PMIN, PMAX] --> [ 1/(1 + s T4) ] --x4
                                         Pref + dPref --(+)
  x4 --> [ K2/(1 + s T5) ] --x5--> [ K3/(1 + s T6) ] --x6          Pm = (1 - K2) x4 + (1 - K3) x5 + x6
  b(w): 0 within +-db, beyond it w minus the nearer edge (db = 0 is IEESGO)
)";
  enum P { T1, T2, T3, T4, T5, T6, K1, K2, K3, PMAX, PMIN, db };
  static constexpr Source defaults_from = literature::andes("IEESGO, commit 0cbe377");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Source kSteam = literature::own("IEEEG1's stages as fractions of the remaining power");
  static constexpr Parameter parameters[] = {
      {"T1", "T1", "s", 0.2, 0.0, 100.0, kNoNullValue, "controller's lag (0: none)",
       literature::own("as IEEEG1's")},
      {"T2", "T2", "s", 0.05, 0.0, 50.0, kNoNullValue, "controller's lead", literature::own("as IEEEG1's")},
      {"T3", "T3", "s", 0.2, 0.0, 100.0, kNoNullValue, "governor's lag (0: neither lag nor lead)",
       literature::own("as IEEEG1's servo")},
      {"T4", "T4", "s", 0.5, 0.0, 50.0, kNoNullValue, "steam inlet (0: none)"},
      {"T5", "T5", "s", 10.0, 0.0, 100.0, kNoNullValue, "reheater (0: none)"},
      {"T6", "T6", "s", 0.5, 0.0, 100.0, kNoNullValue, "crossover (0: none)"},
      {"K1", "K1", "pu", 20.0, 0.0, 200.0, 0.0, "gain, the reciprocal of droop",
       literature::own("5 % droop")},
      {"K2", "K2", "-", 0.7, -3.0, 3.0, kNoNullValue, "fraction that passes the reheater", kSteam},
      {"K3", "K3", "-", 0.43, -3.0, 3.0, kNoNullValue,
       "fraction of the reheater's flow that passes the crossover", kSteam},
      upper_limit({"PMAX", "PMAX", "pu", 1.0, 0.1, 10.0, kNoNullValue, "upper limit of power",
                   literature::own("rated")}),
      lower_limit({"PMIN", "PMIN", "pu", 0.0, -10.0, 1.0, kNoNullValue, "lower limit of power"}),
      {"db", "db", "pu", 0.0, 0.0, 0.02, 0.0, "half width of the intentional dead-band of the speed",
       shared::kNothing, shared::kDeadBand}};
  static constexpr int dyr_columns[] = {T1, T2, T3, T4, T5, T6, K1, K2, K3, PMAX, PMIN};
  enum C { gain, iT1, lead, iT3, iT4, iT5, iT6, share5, share6, high, low, band, Pref, coefficients };
  enum X { controller, governor, inlet, reheat, crossover };
  static constexpr State states[] = {
      {"controller", "pu", "lagged speed", 1.0, -1, -1, {iT1}},
      {.name = "governor",
       .unit = "pu",
       .meaning = "state of the governor's lead-lag",
       .moved_by = {iT3},
       .bends = true},
      {.name = "inlet",
       .unit = "pu",
       .meaning = "flow behind the inlet, x4",
       .moved_by = {iT4},
       .bends = true},
      {"reheat", "pu", "flow behind the reheater, x5", 1.0, -1, -1, {iT5}},
      {"crossover", "pu", "flow behind the crossover, x6", 1.0, -1, -1, {iT6}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_times({T1, T2, T3, T4, T5, T6});
    values.refuse_negative({K1}, "power would rise with speed");
    values.require_above(PMAX, PMIN, "the range of power must not be empty");
    values.refuse_negative({db}, "a width cannot be negative");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[gain] = p[K1];
    c[iT1] = inverse(p[T1]);
    c[lead] = p[T2];
    c[iT3] = inverse(p[T3]);
    c[iT4] = inverse(p[T4]);
    c[iT5] = inverse(p[T5]);
    c[iT6] = inverse(p[T6]);
    c[share5] = p[K2];
    c[share6] = p[K3];
    c[high] = p[PMAX];
    c[low] = p[PMIN];
    c[band] = p[db];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T one(1.0);
    const T lagged = lag(c[iT1], x[controller], c[gain] * dead_band(s.speed, c[band]), dx[controller]);
    const T asked =
        c[Pref] + s.dPref + s.dGref - lead_lag(c[lead], c[iT3], x[governor], lagged, dx[governor]);
    const T x4 = lag(c[iT4], x[inlet], clamp(asked, c[low], c[high]), dx[inlet]);
    const T x5 = lag(c[iT5], x[reheat], c[share5] * x4, dx[reheat]);
    const T x6 = lag(c[iT6], x[crossover], c[share6] * x5, dx[crossover]);
    s.Tm = (one - c[share5]) * x4 + (one - c[share6]) * x5 + x6;
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const double now = value_of(s.Tm);
    if (now > value_of(p[PMAX]) || now < value_of(p[PMIN]))
      return fmt::format(
          "the operating point needs {:.4g} pu of power, outside PMIN = {:g} pu to PMAX = {:g} pu", now,
          value_of(p[PMIN]), value_of(p[PMAX]));
    x[controller] = x[governor] = T(0.0);
    c[Pref] = x[inlet] = s.Tm;
    x[reheat] = p[K2] * s.Tm;
    x[crossover] = p[K3] * x[reheat];
    return {};
  }
};

}  // namespace swingbank::sim::effects::governor_ieesgo
