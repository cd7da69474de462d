#pragma once
// Names of the values of a case's options in configs and on the command line, in the order of their
// enumerators.
#include <algorithm>
#include <string>
#include <vector>

#include "base/config.hpp"

namespace swingbank::sim::grid {

/// Names of the enumerators of Lacking.
inline const std::vector<std::string> kLackingWords = {"no", "zero", "standard"};
/// Names of the enumerators of network::DeviceReplacement.
inline const std::vector<std::string> kDeviceWords = {"checked", "file", "none"};
/// Names of the enumerators of formats::Repeated.
inline const std::vector<std::string> kRepeatedWords = {"refuse", "keep", "voltages"};

/// Returns the enumerator whose name the config has at `key`, or `otherwise` if the key is missing or the
/// name is unknown. An unknown name is recorded as a problem.
template <class Enum>
Enum choose(Config& config, const std::string& key, const std::vector<std::string>& words, Enum otherwise,
            const Range& about) {
  const std::string word = config.choice(key, words, words[static_cast<std::size_t>(otherwise)], about);
  const auto at = std::find(words.begin(), words.end(), word);
  return at == words.end() ? otherwise : static_cast<Enum>(at - words.begin());
}

}  // namespace swingbank::sim::grid
