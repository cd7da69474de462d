#pragma once
// Distance from a switching within which residuals do not count as noise.

namespace swingbank::validate::noise {

/// Samples this close to a switching are left out on either side [s].
constexpr double kBeside = 0.1;

}  // namespace swingbank::validate::noise
