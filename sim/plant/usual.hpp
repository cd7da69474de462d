#pragma once
// Usual ranges of parameters: values outside them, and the range in which a search may vary a parameter.
#include <string>
#include <vector>

#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Returns the indices of values outside [low, high] of their records. Values 99, 999, ... mean "none" and do
/// not count. A block with unusual values is simulated and fitted, with a warning. Only Effect::check refuses
/// values.
std::vector<int> unusual(const Block& block);
/// Returns "VMIN = -1.5 pu".
std::string value_text(const Block& block, int parameter);
/// Returns "usual range of TGOV1: -1 to 1 pu".
std::string usual_text(const Effect& effect, int parameter);
/// Returns the unusual values of a block as sentences: "x.dyr:12: VMIN = -1.5 pu (usual range of TGOV1: -1 to
/// 1 pu)".
std::vector<std::string> unusual_texts(const Block& block, const std::string& where);

/// Interval in which a search may move a parameter.
struct SearchRange {
  double low, high;  ///< ends of the interval [unit of the parameter]
};
/// Returns the search range of a parameter with the value `value` in its model. A value outside the usual
/// range extends the range beyond itself by the range's width. The extension crosses zero only if the usual
/// range does or the value has the other sign.
SearchRange search_range(const Parameter& record, double value);

}  // namespace swingbank::sim::plant
