#pragma once
// Rules for the sign of a fitted parameter, and for fitting its logarithm instead of its value.
#include <cmath>

#include "sim/core/effect.hpp"

namespace swingbank::validate::fit {

/// Returns whether a fit may move the parameter through zero. Its range must include negative values, and its
/// upper limit must not exceed ten times the default value. An example is an exciter's KE (-1 to 2, default
/// 1). A gain whose range spans decades keeps its sign.
inline bool may_change_sign(const sim::Parameter& p) {
  constexpr double kDecade = 10;
  return p.low < 0 && p.high > 0 && p.high <= kDecade * std::abs(p.default_value);
}
/// Returns whether a fit moves the logarithm of a parameter that starts at `start`, instead of the value.
inline bool moves_by_logarithm(const sim::Parameter& p, double start) {
  return start > 0 && !may_change_sign(p);
}

}  // namespace swingbank::validate::fit
