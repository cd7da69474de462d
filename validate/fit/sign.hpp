#pragma once
// Whether the sign of a parameter is open, and on which scale a fit moves it.
#include <cmath>

#include "sim/core/effect.hpp"

namespace swingbank::validate::fit {

/// Whether a fit may lead the parameter through zero: its range reaches below zero, and not a decade beyond
/// its standard value, as that of an exciter's KE does (-1 to 2, standard 1). A gain of either sign, whose
/// range spans decades, keeps the sign it has.
inline bool may_change_sign(const sim::Parameter& p) {
  constexpr double kDecade = 10;
  return p.low < 0 && p.high > 0 && p.high <= kDecade * std::abs(p.standard);
}
/// Whether a fit moves the logarithm of a parameter that starts at `start`, and not the value itself.
inline bool moves_by_logarithm(const sim::Parameter& p, double start) {
  return start > 0 && !may_change_sign(p);
}

}  // namespace swingbank::validate::fit
