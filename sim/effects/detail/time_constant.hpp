#pragma once
// The rule for a time constant of zero, one for all effects. A lag or lead-lag with T = 0 passes its input
// (sim/core/blocks.hpp). Any other block, such as a washout or a rate feedback, needs T > 0 where it acts;
// where its gain is 0 or nothing reads its output it is switched off and needs T >= 0 only. prepare() then
// takes inverse(T), which is 0 for T = 0: the state of the block stays at its steady value.
#include <fmt/format.h>

#include <string>
#include <string_view>

#include "base/problem.hpp"

namespace swingbank::sim::effects::shared {

/// Notes a time constant [s] that breaks the rule. `model`: what divides by it; `acts`: whether its block
/// acts; `off`: what switches the block off ("KF = 0").
inline void check_time_constant(std::string_view model, std::string_view symbol, double seconds, bool acts,
                                std::string_view off, const std::string& where, Problems& problems) {
  if (acts ? seconds > 0 : seconds >= 0) return;
  const std::string what = fmt::format("{} = {:g} s", symbol, seconds);
  if (acts)
    problems.add(what, where, fmt::format("{} divides by it", model),
                 fmt::format("give {} > 0, or {}, which switches the block off", symbol, off));
  else
    problems.add(what, where, "a time constant", fmt::format("give {} >= 0", symbol));
}

}  // namespace swingbank::sim::effects::shared
