#include "validate/record/detail/phase.hpp"

#include <map>
#include <string>

#include "validate/record/detail/columns.hpp"

namespace swingbank::validate::record {

std::optional<Phase> phase_of(std::string_view text) {
  static const std::map<std::string, std::size_t, std::less<>> letters = {
      {"a", 0},  {"r", 0}, {"u", 0}, {"l1", 0}, {"1", 0}, {"b", 1},  {"s", 1}, {"v", 1},
      {"l2", 1}, {"2", 1}, {"c", 2}, {"t", 2},  {"w", 2}, {"l3", 2}, {"3", 2}};
  const std::string name = normalised(text);
  const auto single = [&](std::string_view part) {
    const auto at = letters.find(part);
    return at == letters.end() ? std::nullopt : std::optional(at->second);
  };
  if (const auto p = single(name)) return Phase{*p};
  // A trailing 'n' or 'g' names neutral or ground.
  if (name.size() > 1 && (name.back() == 'n' || name.back() == 'g'))
    if (const auto p = single(std::string_view(name).substr(0, name.size() - 1))) return Phase{*p};
  std::string_view pair = name;
  const bool numbers = name.size() == 3 && name[0] == 'l';  // "l12"
  if (numbers) pair.remove_prefix(1);
  for (const std::size_t length : {std::size_t{1}, std::size_t{2}}) {
    if (pair.size() != 2 * length) continue;
    const auto from = single(pair.substr(0, length)), to = single(pair.substr(length));
    if (from && to && *from != *to) {
      const bool forward = *to == (*from + 1) % 3;
      return Phase{forward ? *from : *to, true, !forward};
    }
  }
  return std::nullopt;
}

}  // namespace swingbank::validate::record
