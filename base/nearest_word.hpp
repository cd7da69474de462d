#pragma once
// The known word nearest to a mistyped one, for "did you mean".
#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <utility>
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

/// Returns the one of `words` that was probably meant, whatever the case of its letters; empty if none is
/// near. A word that begins with the wanted one, of three letters or more, comes before all others.
inline std::string nearest_word(std::string_view wanted, const std::vector<std::string>& words) {
  const auto lower = [](std::string_view text) {
    std::string small(text);
    std::ranges::transform(small, small.begin(), [](unsigned char c) { return std::tolower(c); });
    return small;
  };
  const std::string sought = lower(wanted);
  const std::size_t most =
      std::max<std::size_t>(1, sought.size() / 3);  // farther than this is no likely slip
  std::string best;
  std::pair<bool, std::size_t> least;  // whether it only resembles the wanted one, and its distance
  for (const auto& word : words) {
    const std::string known = lower(word);
    const bool begins = sought.size() >= 3 && known.starts_with(sought);
    const std::pair<bool, std::size_t> distance{!begins, edit_distance(sought, known)};
    if (!begins && (distance.second > most || distance.second >= known.size())) continue;
    if (best.empty() || distance < least) {
      best = word;
      least = distance;
    }
  }
  return best;
}
/// Returns "did you mean GENROU?", or `otherwise` where no word is near.
inline std::string suggestion(std::string_view wanted, const std::vector<std::string>& words,
                              const std::string& otherwise) {
  const std::string nearest = nearest_word(wanted, words);
  return nearest.empty() ? otherwise : "did you mean " + nearest + "?";
}

}  // namespace swingbank
