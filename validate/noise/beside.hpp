#pragma once
// Distance from a switching within which residuals do not count as noise.

namespace swingbank::validate::noise {

/// Samples closer than this to a switching, before or after it, are not used to estimate noise [s].
constexpr double kBeside = 0.1;

}  // namespace swingbank::validate::noise
