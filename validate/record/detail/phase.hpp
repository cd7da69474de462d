#pragma once
// A phase of a three-phase quantity and its usual spellings.
#include <cstddef>
#include <optional>
#include <string_view>

namespace swingbank::validate::record {

/// Phase of a quantity: 0, 1, 2 for a, b, c; of a line-to-line voltage 0, 1, 2 for ab, bc, ca.
struct Phase {
  std::size_t number = 0;
  bool between = false;   ///< line to line
  bool reversed = false;  ///< ba, cb, ac
  friend bool operator==(const Phase&, const Phase&) = default;
};
/// Parses a phase in its usual spellings: "A", "an", "L1", "R", "U", "ab", "L1L2".
std::optional<Phase> phase_of(std::string_view text);

}  // namespace swingbank::validate::record
