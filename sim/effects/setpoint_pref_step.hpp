#pragma once
// PREFSTEP: step of the governor's reference.
#include "sim/effects/detail/setpoint_move.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::setpoint_pref_step {

struct Model : shared::SetpointStep<Model> {
  static constexpr std::string_view name = "PREFSTEP", title = "step of the governor's reference";
  static constexpr std::string_view description = R"(
            amount |       ______
  dPref :         0 |______|      |______
                          t1     t2
  Exactly zero before t1 and from t2 on.
)";
  static constexpr Source bounds_from = shared::kRating;
  static constexpr Parameter parameters[] = {
      {"amount", "dPref", "pu", 0.0, -1.0, 1.0, 0.0, "change of the governor's reference"}, kStart, kEnd};

  template <class T>
  static T& moved(Signals<T>& s) {
    return s.dPref;
  }
};

}  // namespace swingbank::sim::effects::setpoint_pref_step
