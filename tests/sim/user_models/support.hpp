#pragma once
// Small user-defined models for the tests.
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "sim/user_models/user_model.hpp"

namespace swingbank::sim::test {

inline constexpr const char* kHead = "title = \"test\"\nsource = \"tests/sim/core\"\n";

/// User-defined model that computes `output` by the given lines.
inline std::string user_model_of(const std::string& output, const std::string& action,
                                 const std::string& rest) {
  return fmt::format("name = \"X\"\n{}output = \"{}\"\naction = \"{}\"\n{}", kHead, output, action, rest);
}

/// Example that repeats the compiled exciter SEXS.
inline const Effect& sexs_user_model() {
  static const library::EffectLibrary library = [] {
    library::EffectLibrary made;
    user_models::load_user_model(std::filesystem::path(SWINGBANK_SOURCE) / "configs/user_models/sexs.toml",
                                 made);
    return made;
  }();
  return *library.find("SEXSLAW");
}

/// Nonlinear user-defined model.
inline constexpr const char* kNonlinear = R"law(
name = "NONLINEAR"
title = "a bit of everything"
source = "test"
output = "Vs"
action = "replace"
value = "clamp(K * washed * abs(washed) + 0.05 * sin(square), -limit, limit)"
[signals]
e = "deadband(speed, band) * 50 + (P - P0)"
washed = "e - x"
[states.x]
unit = "pu"
meaning = "washout"
derivative = "(e - x) / T"
[states.square]
unit = "pu"
meaning = "rests at sqrt(V): found by Newton's method"
derivative = "10 * (V - square^2) + 0.1 * min(washed, max(e, -0.1))"
start = "1"
[parameters]
K = { unit = "pu", default = 5.0, low = 0.0, high = 100.0, null_value = 0.0, meaning = "gain" }
T = { unit = "s", default = 2.0, low = 0.1, high = 100.0, meaning = "washout" }
band = { unit = "pu", default = 0.0005, low = 0.0, high = 0.1, meaning = "dead-band" }
limit = { unit = "pu", default = 0.1, low = 0.01, high = 1.0, meaning = "limit" }
)law";

}  // namespace swingbank::sim::test
