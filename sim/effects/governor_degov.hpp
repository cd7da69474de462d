#pragma once
// DEGOV: isochronous governor of a diesel engine.
#include "sim/effects/detail/diesel.hpp"

namespace swingbank::sim::effects::governor_degov {

struct Model : shared::Diesel<Model> {
  static constexpr std::string_view name = "DEGOV", title = "diesel engine and isochronous governor",
                                    source = "PSS/E DEGOV (Woodward); OpenIPSL, DEGOV", dyr_name = "DEGOV";
  static constexpr std::string_view variant_of = "DEGOV1";
  static constexpr std::string_view description = R"(
  dPref - w --> [ (1 + s T3)/(1 + s T1 + s^2 T1 T2) ] --> [ K (1 + s T4)/(s (1 + s T5)(1 + s T6)) ] --> throttle
         throttle and integral: [TMIN, TMAX], non-windup
  Pm = (1 + w) exp(-s TD) throttle
  exp(-s TD): Pade approximation of orders 3 and 4; T1 = 0: no control box; T5 = 0: neither the lag T5 nor the lead T4
)";
  enum P { T1, T2, T3, K, T4, T5, T6, TD, TMAX, TMIN };
  static constexpr Parameter parameters[] = {kT1, kT2, kT3, kK, kT4, kT5, kT6, kTD, kTMAX, kTMIN};
  static constexpr int dyr_columns[] = {T1, T2, T3, K, T4, T5, T6, TD, TMAX, TMIN};
  enum { coefficients = own };
  static constexpr std::span<const State> states = kStates;

  template <class T>
  static T asked(const T*, const T*, const Signals<T>& s, T*) {
    return s.dPref + s.dGref - s.speed;
  }
  template <class T>
  static std::string steady(const T*, T*, Signals<T>& s, T* x) {
    return steady_engine(s, x);
  }
};

}  // namespace swingbank::sim::effects::governor_degov
