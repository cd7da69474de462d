#include "validate/plant/unknown_keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/nearest_word.hpp"

namespace swingbank::validate::plant {

void refuse_unknown_keys(Config& config, const std::string& at, const std::string& name,
                         const std::vector<std::string>& known) {
  const std::vector<std::string> keys = config.keys(at);
  std::vector<std::string> missing;
  std::ranges::copy_if(known, std::back_inserter(missing),
                       [&](const auto& key) { return std::ranges::count(keys, key) == 0; });
  for (const auto& key : keys) {
    if (std::ranges::count(known, key) > 0) continue;
    const std::string full = at + "." + key, nearest = nearest_word(key, missing);
    config.problem(full, "unknown key " + full, name + " has no such key",
                   fmt::format("remove it or use one of: {}{}", fmt::join(known, ", "),
                               nearest.empty() ? "" : "; did you mean " + nearest + "?"));
  }
}

}  // namespace swingbank::validate::plant
