#pragma once
// Positions of channels in a record.
#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::train::data {

/// Returns the index of a channel; -1 if the record has no channel of that name.
inline int channel_index(const std::vector<std::string>& names, std::string_view name) {
  const auto found = std::ranges::find(names, name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

/// Adds a problem for each channel of `required` that the record lacks. `why`: reason why it is needed.
inline void require_channels(const std::vector<std::string>& names,
                             std::initializer_list<std::string_view> required, const std::string& why,
                             Problems& problems) {
  for (const std::string_view name : required)
    if (channel_index(names, name) < 0)
      problems.add(
          "no channel " + std::string(name), "channels", why,
          "add it to the experiment's channels (the dataset must record it), or choose another `form`");
}

}  // namespace swingbank::train::data
