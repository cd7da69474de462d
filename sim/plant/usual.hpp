#pragma once
// Which values of a block lie outside the range that its effect calls usual, and how far a search may move
// from a value.
#include <string>
#include <vector>

#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Values outside [low, high] of their records, by number, but for 99, 999, ..., which stand for "none". Such
/// a block is run, played and fitted like any other, and said to be unusual: what no equation can take is
/// refused by Effect::check alone, whoever reads the values.
std::vector<int> unusual(const Block& block);
/// "VMIN = -1.5 pu".
std::string value_text(const Block& block, int parameter);
/// "TGOV1's is usually -1 to 1 pu".
std::string usual_text(const Effect& effect, int parameter);
/// The unusual values of a block as sentences: "x.dyr:12: VMIN = -1.5 pu (TGOV1's is usually -1 to 1 pu)".
std::vector<std::string> unusual_texts(const Block& block, const std::string& where);

struct SearchRange {
  double low, high;
};
/// Where a search may look for a parameter that has this value in its model. A value outside the usual range
/// shows that this range does not hold for it: on that side it may move as far again as the range is wide,
/// but to zero only where the range ends there.
SearchRange search_range(const Parameter& record, double value);

}  // namespace swingbank::sim::plant
