#pragma once
// VREFRAMP: ramp of the exciter's reference.
#include "sim/effects/detail/setpoint_move.hpp"

namespace swingbank::sim::effects::setpoint_vref_ramp {

struct Model : shared::SetpointRamp<Model> {
  static constexpr std::string_view name = "VREFRAMP", title = "ramp of the exciter's reference";
  static constexpr std::string_view description = R"(
            amount |        ________
                   |       /
  dVref :         0 |______/
                        t1   t1 + T
  Before t1 exactly zero; stays at `amount` after t1 + T.
)";
  static constexpr Source bounds_from = literature::own("half of the rated voltage");
  static constexpr Parameter parameters[] = {
      {"amount", "dVref", "pu", 0.0, -0.5, 0.5, 0.0, "change of the exciter's reference"}, kStart, kDuration};

  template <class T>
  static T& moved(Signals<T>& s) {
    return s.dVref;
  }
};

}  // namespace swingbank::sim::effects::setpoint_vref_ramp
