#pragma once
// The known word nearest to a mistyped one, for "did you mean".
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank {

/// Returns how many letters must be inserted, removed or replaced to turn `a` into `b`.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replace});
    }
  }
  return row.back();
}

/// Returns the one of `words` that was probably meant; empty if none is near. The begin of a word, of three
/// letters or more, stands for it.
inline std::string nearest_word(std::string_view wanted, const std::vector<std::string>& words) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, wanted.size() / 3);  // farther than this is no likely slip
  for (const auto& word : words) {
    const bool begins = wanted.size() >= 3 && word.starts_with(wanted);
    const std::size_t distance = begins ? 0 : edit_distance(wanted, word);
    if (distance <= least && (best.empty() || distance < least)) {
      best = word;
      least = distance;
    }
  }
  return best;
}

}  // namespace swingbank
