#include "validate/report/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace swingbank::validate::report {

std::string ratio_text(double ratio) {
  if (!std::isfinite(ratio)) return "–";
  return ratio < 9.95 ? fmt::format("{:.1f}", ratio) : fmt::format("{:.0f}", ratio);
}

std::string times_noise(double ratio) { return ratio_text(ratio) + (std::isfinite(ratio) ? " ×" : ""); }

std::ptrdiff_t characters(std::string_view text) {
  return std::ranges::count_if(text, [](unsigned char c) { return (c & 0xC0) != 0x80; });
}

std::string probability_text(double probability) {
  const double percent = 100 * probability;
  if (percent < 1) return "< 1 %";
  if (percent > 99) return "> 99 %";
  return fmt::format("{:.0f} %", percent);
}

}  // namespace swingbank::validate::report
