#pragma once
// Words of a case's options in configs and on the command line, in the order of their enumerators.
#include <algorithm>
#include <string>
#include <vector>

#include "base/config.hpp"

namespace swingbank::sim::grid {

/// Of Lacking.
inline const std::vector<std::string> kLackingWords = {"no", "zero", "standard"};
/// Of network::DeviceReplacement.
inline const std::vector<std::string> kDeviceWords = {"checked", "file", "none"};
/// Of formats::Repeated.
inline const std::vector<std::string> kRepeatedWords = {"refuse", "keep", "voltages"};

/// Returns the enumerator whose word a config has at `key`; `otherwise` if the key is missing or its word is
/// unknown, which is recorded as a problem.
template <class Enum>
Enum choose(Config& config, const std::string& key, const std::vector<std::string>& words, Enum otherwise,
            const Range& about) {
  const std::string word = config.choice(key, words, words[static_cast<std::size_t>(otherwise)], about);
  const auto at = std::find(words.begin(), words.end(), word);
  return at == words.end() ? otherwise : static_cast<Enum>(at - words.begin());
}

}  // namespace swingbank::sim::grid
