#pragma once
// Rivals of the best hypothesis get a chance: further starts, parts that their standard values leave off, and
// a look elsewhere, in the order of what these cost.
#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {

/// Rivals of the best in its slot are fitted from further starts, and with what their standard values leave
/// off, if they come near it at all; then they are looked at elsewhere (try_basins). Puts the best first.
/// `gain` is over the stage's fit.
void give_rivals_a_chance(const Stage& stage, std::vector<Judgement>& tried,
                          const event::Progress& report = {});

/// Where nothing holds, anything that nearly fits may have ended at the lesser of several optima, whatever
/// its slot. The next ones that were not looked at elsewhere yet are fitted on and looked at, the best first,
/// those of one slot together. Returns which, by their places in `tried`; none are left if empty.
std::vector<std::size_t> look_at_next(const Stage& stage, std::vector<Judgement>& tried,
                                      const event::Progress& report = {});

}  // namespace swingbank::validate::hypothesis
