#pragma once
// STEPUP: the unit transformer between the machine's terminal and the grid.
#include <fmt/format.h>

#include "sim/core/effect.hpp"

namespace swingbank::sim::effects::transformer_stepup {

struct Model {
  static constexpr std::string_view name = "STEPUP", title = "step-up transformer",
                                    source = "Kundur (1994), 6.2: two-winding transformer, off-nominal ratio";
  static constexpr Slot slot = Slot::transformer;
  static constexpr std::string_view description = R"(
  machine's terminal --[ R + jX ]--( 1 : ratio )-- grid

  V_machine = V_grid / ratio + (R + jX) I_machine        I_grid = I_machine / ratio
  R, X per unit on the machine's base; no charging, no magnetising current.
)";
  enum P { R, X, ratio };
  static constexpr Source defaults_from = literature::own("no losses, nominal ratio");
  static constexpr Source bounds_from = literature::own("far beyond a power transformer");
  static constexpr Parameter parameters[] = {
      {"R", "R", "pu", 0.0, 0.0, 0.1, 0.0, "resistance on the machine's base"},
      {"X", "X", "pu", 0.1, 0.0, 1.0, 0.0, "leakage reactance on the machine's base",
       literature::own("a typical value")},
      {"ratio", "n", "-", 1.0, 0.5, 2.0, 1.0, "off-nominal ratio, grid side over machine side"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const auto refuse = [&](P i, bool wrong, const char* why, const char* remedy) {
      if (wrong)
        problems.add(fmt::format("{} = {:g} {}", parameters[i].name, p[i], parameters[i].unit), where, why,
                     remedy);
    };
    refuse(R, !(p[R] >= 0), "a resistance cannot be negative", "give R >= 0");
    refuse(X, !(p[X] >= 0), "a leakage reactance cannot be negative", "give X >= 0");
    refuse(ratio, !(p[ratio] > 0), "the voltages of both sides have the same sign", "give a ratio near 1");
  }

  template <class T>
  static void impedance(const T* p, T& r, T& x, T& n) {
    r = p[R];
    x = p[X];
    n = p[ratio];
  }
};

}  // namespace swingbank::sim::effects::transformer_stepup
