#pragma once
// Spelling suggestions: the known word nearest to a mistyped one, for "did you mean".
#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace swingbank {

/// Returns the edit distance between `a` and `b`: the smallest number of insertions, deletions, substitutions
/// and swaps of neighbouring letters (optimal string alignment).
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({row[j - 1] + 1, last[j] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = std::exchange(last, row);
  }
  return last.back();
}

/// Returns the word of `words` with the smallest edit distance to `wanted`, ignoring case; empty if none is
/// near. Words that begin with `wanted` (at least three letters) are preferred.
inline std::string nearest_word(std::string_view wanted, const std::vector<std::string>& words) {
  const auto lower = [](std::string_view text) {
    std::string small(text);
    std::ranges::transform(small, small.begin(), [](unsigned char c) { return std::tolower(c); });
    return small;
  };
  const std::string sought = lower(wanted);
  const std::size_t most = std::max<std::size_t>(1, sought.size() / 3);  // largest plausible edit distance
  std::string best;
  // sort key: 0 for a word that begins with `wanted`, edit distance, difference in length
  std::array<std::size_t, 3> least{};
  for (const auto& word : words) {
    const std::string known = lower(word);
    const bool begins = sought.size() >= 3 && known.starts_with(sought);
    const std::size_t slips = edit_distance(sought, known);
    if (!begins && (slips > most || 2 * slips >= std::max(known.size(), sought.size()))) continue;
    const std::array<std::size_t, 3> distance{
        begins ? 0U : 1U, slips,
        std::max(known.size(), sought.size()) - std::min(known.size(), sought.size())};
    if (best.empty() || distance < least) {
      best = word;
      least = distance;
    }
  }
  return best;
}
/// Returns "did you mean GENROU?", or `otherwise` if no word is near.
inline std::string suggestion(std::string_view wanted, const std::vector<std::string>& words,
                              const std::string& otherwise) {
  const std::string nearest = nearest_word(wanted, words);
  return nearest.empty() ? otherwise : "did you mean " + nearest + "?";
}

}  // namespace swingbank
