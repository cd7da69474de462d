#pragma once
// JSON of numbers that may be infinite or undefined.
#include <cmath>

#include "base/json.hpp"

namespace swingbank::validate::live {

/// Returns the number, or null if it is not finite: JSON has neither infinity nor NaN.
inline nlohmann::json number(double v) {
  return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(nullptr);
}

}  // namespace swingbank::validate::live
