#pragma once
// VREFSTEP: step of the exciter's reference.
#include "sim/effects/detail/setpoint_move.hpp"

namespace swingbank::sim::effects::setpoint_vref_step {

struct Model : shared::SetpointStep<Model> {
  static constexpr std::string_view name = "VREFSTEP", title = "step of the exciter's reference";
  static constexpr std::string_view description = R"(
            amount |       ______
  dVref :         0 |______|      |______
                          t1     t2
  Exactly zero before t1 and from t2 on.
)";
  static constexpr Source bounds_from = literature::own("half of the rated voltage");
  static constexpr Parameter parameters[] = {
      {"amount", "dVref", "pu", 0.0, -0.5, 0.5, 0.0, "change of the exciter's reference"}, kStart, kEnd};

  template <class T>
  static T& moved(Signals<T>& s) {
    return s.dVref;
  }
};

}  // namespace swingbank::sim::effects::setpoint_vref_step
