#pragma once
// Whether the sign of a parameter is open.
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

}  // namespace swingbank::validate::fit
