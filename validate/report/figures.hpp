#pragma once
// Figures as text, the same in all reports: multiples of the noise, and probabilities.
#include <cstddef>
#include <string>
#include <string_view>

namespace swingbank::validate::report {

/// Returns a ratio with one decimal below 10 and none above, "0.9" or "85"; "–" if not finite.
std::string ratio_text(double ratio);

/// Returns a multiple of the noise, "0.9 ×" or "85 ×"; "–" if not finite.
std::string times_noise(double ratio);

/// Returns the number of characters of a text in UTF-8.
std::ptrdiff_t characters(std::string_view text);

/// Returns for example "97 %"; "< 1 %" and "> 99 %" at the ends, never 0 or 100 %.
std::string probability_text(double probability);

}  // namespace swingbank::validate::report
