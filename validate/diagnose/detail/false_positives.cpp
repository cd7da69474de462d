#include "validate/diagnose/detail/false_positives.hpp"

#include <fmt/format.h>

namespace swingbank::validate::diagnose {

std::string false_positive_note() {
  return fmt::format(
      "False positives of the diagnosis: {} of {} blind cases without a hidden effect (95 % "
      "interval {:.1f} to {:.0f} %; docs/reference/blind-test-results.md).",
      kFalsePositives.hits, kFalsePositives.n, 100 * kFalsePositives.low(), 100 * kFalsePositives.high());
}

}  // namespace swingbank::validate::diagnose
