#pragma once
// PREFRAMP: ramp of the governor's reference.
#include "sim/effects/detail/setpoint_move.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::setpoint_pref_ramp {

struct Model : shared::SetpointRamp<Model> {
  static constexpr std::string_view name = "PREFRAMP", title = "ramp of the governor's reference";
  static constexpr std::string_view description = R"(
            amount |        ________
                   |       /
  dPref :         0 |______/
                        t1   t1 + T
  Before t1 exactly zero; stays at `amount` after t1 + T.
)";
  static constexpr Source bounds_from = shared::kRating;
  static constexpr Parameter parameters[] = {
      {"amount", "dPref", "pu", 0.0, -1.0, 1.0, 0.0, "change of the governor's reference"},
      kStart,
      kDuration};

  template <class T>
  static T& moved(Signals<T>& s) {
    return s.dPref;
  }
};

}  // namespace swingbank::sim::effects::setpoint_pref_ramp
