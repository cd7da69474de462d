#pragma once
// Distance from a switching within which residuals do not count as noise.

namespace swingbank::validate::noise {

/// Samples closer than this to a switching, before or after it, are not used to estimate noise [s]. The
/// pre-event segment is an exception: its variance is estimated from all of its samples.
constexpr double kBeside = 0.1;

}  // namespace swingbank::validate::noise
