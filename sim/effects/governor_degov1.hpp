#pragma once
// DEGOV1: governor of a diesel engine with droop.
#include <algorithm>

#include "sim/effects/detail/diesel.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_degov1 {

struct Model : shared::Diesel<Model> {
  static constexpr std::string_view name = "DEGOV1", title = "diesel engine and governor with droop",
                                    source =
                                        "PSS/E DEGOV1 (Woodward); Modelica ePHASOR components (OPAL-RT), "
                                        "DEGOV1",
                                    dyr_name = "DEGOV1";
  static constexpr std::string_view description = R"(
  Pref + DROOP dPref - w - DROOP f --> [ (1 + s T3)/(1 + s T1 + s^2 T1 T2) ]
         --> [ K (1 + s T4)/(s (1 + s T5)(1 + s T6)) ] --> throttle; it and the integral: [TMIN, TMAX], non-windup
  f: throttle (M = 0), electrical power behind 1/(1 + s TE) (M = 1)
  Pm = (1 + w) exp(-s TD) throttle
  exp(-s TD): Pade approximation of orders 3 and 4; T1 = 0: no control box; T5 = 0: neither the lag T5 nor the lead T4
)";
  enum P { M, T1, T2, T3, K, T4, T5, T6, TD, TMAX, TMIN, DROOP, TE };
  static constexpr Parameter parameters[] = {
      {"M", "M", "code", 0.0, 0.0, 1.0, kNoNullValue, "droop feedback: 0 throttle, 1 electrical power",
       kAsEffect, shared::kCode},
      kT1,
      kT2,
      kT3,
      kK,
      kT4,
      kT5,
      kT6,
      kTD,
      kTMAX,
      kTMIN,
      {"DROOP", "DROOP", "pu", 0.05, 0.0, 1.0, 0.0, "permanent droop"},
      {"TE", "TE", "s", 0.1, 0.0, 30.0, kNoNullValue, "power transducer (0: none)"}};
  static constexpr int dyr_columns[] = {M, T1, T2, T3, K, T4, T5, T6, TD, TMAX, TMIN, DROOP, TE};
  enum { droop = own, of_power, iTE, Pref, coefficients };
  enum { power = own_states };
  static constexpr auto states = [] {
    std::array<State, own_states + 1> all{};
    std::copy(kStates.begin(), kStates.end(), all.begin());
    all[power] = {"power", "pu", "measured electrical power", 1.0, -1, -1, {iTE}};
    return all;
  }();

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    Diesel::check(p, where, problems);
    values.require_switches({M});
    values.refuse_negative({DROOP}, "power would rise with speed");
    values.require_times({TE});
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    Diesel::prepare(p, conventions, c);
    c[droop] = p[DROOP];
    c[of_power] = p[M];
    c[iTE] = inverse(p[TE]);
  }
  template <class T>
  static T asked(const T* c, const T* x, const Signals<T>& s, T* dx) {
    const T measured = lag(c[iTE], x[power], s.P, dx[power]);
    const T fed = c[of_power] * measured + (T(1.0) - c[of_power]) * clamp(x[throttle], c[low], c[high]);
    return c[Pref] + s.dGref + c[droop] * (s.dPref - fed) - s.speed;
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    x[power] = s.P;
    c[Pref] = p[DROOP] * (c[of_power] * s.P + (T(1.0) - c[of_power]) * s.Tm);
    return steady_engine(s, x);
  }
};

}  // namespace swingbank::sim::effects::governor_degov1
