#include "validate/blind_measured.hpp"

#include <fmt/format.h>

namespace swingbank::validate {

std::string false_positive_note() {
  return fmt::format(
      "Of {} blind cases in which nothing was hidden, {} were given an effect (95 % interval {:.0f} to "
      "{:.0f} %; "
      "docs/blind-test.md).",
      kFalsePositives.n, kFalsePositives.hits, 100 * kFalsePositives.low(), 100 * kFalsePositives.high());
}

}  // namespace swingbank::validate
