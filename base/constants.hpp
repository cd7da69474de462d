#pragma once
// Mathematical constants that several modules use.
#include <limits>
#include <numbers>

namespace swingbank::constants {

inline constexpr double pi = std::numbers::pi;         ///< ratio of circumference to diameter
inline constexpr double turn = 2 * pi;                 ///< angle of a full turn [rad]
inline constexpr double degree = pi / 180;             ///< angle of one degree [rad]
inline constexpr double degrees_in_radian = 180 / pi;  ///< degrees in one radian

/// Two-sided 95 % and 99 % quantiles of the standard normal distribution.
inline constexpr double normal95 = 1.959963984540054;
inline constexpr double normal99 = 2.5758293035489004;  ///< 99 %

/// Value of a quantity that is unknown (not a number).
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace swingbank::constants
