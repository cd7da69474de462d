#pragma once
// Position of a channel in a record.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank::train::data {

/// Returns the number of a channel; -1 if the record has none of that name.
inline int channel_index(const std::vector<std::string>& names, std::string_view name) {
  const auto found = std::ranges::find(names, name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

}  // namespace swingbank::train::data
