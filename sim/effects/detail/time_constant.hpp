#pragma once
// Common rule of all effects for a time constant of zero. A lag or lead-lag with T = 0 passes its input
// (sim/core/blocks.hpp). Any other block, such as a washout or a rate feedback, requires T > 0 if it acts. A
// block with zero gain or an unused output is off and requires only T >= 0. Its state then keeps the steady
// value, because prepare() takes inverse(T), which is 0 for T = 0.
#include <fmt/format.h>

#include <string>
#include <string_view>

#include "base/problem.hpp"

namespace swingbank::sim::effects::shared {

/// Adds a problem for a time constant [s] that violates the rule. `model`: model that divides by it; `acts`:
/// true if its block acts; `off`: condition that switches the block off ("KF = 0").
inline void check_time_constant(std::string_view model, std::string_view symbol, double seconds, bool acts,
                                std::string_view off, const std::string& where, Problems& problems) {
  if (acts ? seconds > 0 : seconds >= 0) return;
  const std::string what = fmt::format("{} = {:g} s", symbol, seconds);
  if (acts)
    problems.add(what, where, fmt::format("{} divides by it", model),
                 fmt::format("give {} > 0, or {}, which switches the block off", symbol, off));
  else
    problems.add(what, where, "a time constant cannot be negative", fmt::format("give {} >= 0", symbol));
}

}  // namespace swingbank::sim::effects::shared
