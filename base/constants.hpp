#pragma once
// Numbers of mathematics that several rooms use.
#include <numbers>

namespace swingbank::constants {

inline constexpr double pi = std::numbers::pi;
inline constexpr double turn = 2 * pi;      ///< angle of a full turn [rad]
inline constexpr double degree = pi / 180;  ///< angle of one degree [rad]
inline constexpr double degrees_in_radian = 180 / pi;

/// A normal variable stays within so many standard deviations of its mean, on both sides, with a probability
/// of 95 % and of 99 %.
inline constexpr double normal95 = 1.959963984540054;
inline constexpr double normal99 = 2.5758293035489004;

}  // namespace swingbank::constants
