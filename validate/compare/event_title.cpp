#include "validate/compare/event_title.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "validate/record/record.hpp"

namespace swingbank::validate::compare {
namespace {

constexpr double kFaultDip = 0.1;          ///< smallest relative voltage dip of a fault
constexpr double kFrequencyChange = 0.05;  ///< smallest change of a frequency event [Hz]
constexpr double kFrequencyAverage = 1.0;  ///< averaging time of the frequency [s]

constexpr double kQuietTime = 120;  ///< longer than the response of any plant control [s]

double mean_of(const std::vector<double>& x, std::size_t begin, std::size_t end) {
  return std::accumulate(x.begin() + static_cast<std::ptrdiff_t>(begin),
                         x.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
         static_cast<double>(end - begin);
}

/// Returns whether the voltage dips between the first and the last switching.
bool is_fault(const EventComparison& e) {
  const record::Record& r = e.record;
  if (e.switchings.size() < 2 || r.V.size() != r.t.size()) return false;
  const auto begin =
      static_cast<std::size_t>(std::ranges::upper_bound(r.t, e.switchings.front().time) - r.t.begin());
  const auto end =
      static_cast<std::size_t>(std::ranges::lower_bound(r.t, e.switchings.back().time) - r.t.begin());
  if (begin == 0 || begin >= end) return false;
  return mean_of(r.V, begin, end) < (1 - kFaultDip) * mean_of(r.V, 0, begin);
}

/// Returns the largest change of the averaged frequency from its pre-event mean [Hz]; 0 if not recorded.
double frequency_change(const EventComparison& e) {
  const record::Record& r = e.record;
  const double nominal = r.base.frequency;
  std::vector<double> f = r.f;
  if (f.size() != r.t.size()) {
    if (r.angle == record::AngleSource::none || r.theta.size() != r.t.size()) return 0;
    f = frequency_of(r.t, r.theta, nominal);
  }
  const auto quiet = static_cast<std::size_t>(std::max(e.playback.start.samples, 1));
  const auto average = static_cast<std::size_t>(std::max(kFrequencyAverage / r.step(), 1.0));
  if (quiet >= f.size()) return 0;
  const double before = mean_of(f, 0, quiet);
  double largest = 0;
  for (std::size_t k = quiet; k + average <= f.size(); k += std::max<std::size_t>(average / 2, 1))
    if (const double change = mean_of(f, k, k + average) - before; std::abs(change) > std::abs(largest))
      largest = change;
  return largest * nominal;
}

std::string switchings_text(const EventComparison& e) {
  std::string text = e.switchings.size() > 1 ? "switchings at " : "switching at ";
  for (const auto& s : e.switchings)
    text += fmt::format("{}{:.3f} s", &s == e.switchings.data() ? "" : ", ", s.time);
  return text;
}

}  // namespace

std::string event_title(const EventComparison& e) {
  if (is_fault(e))
    return fmt::format("fault at {:.3f} s, {:.0f} ms", e.switchings.front().time,
                       1e3 * (e.switchings.back().time - e.switchings.front().time));
  std::string text;
  for (const auto& staged : e.record.staged)
    text += fmt::format("{}{} at {:.3f} s", text.empty() ? "" : ", ", record::staged_name(staged.kind),
                        staged.time);
  if (text.empty() && !e.switchings.empty()) text = switchings_text(e);
  const double change = frequency_change(e);
  if (std::abs(change) >= kFrequencyChange)
    text += fmt::format("{} {:+.2f} Hz", text.empty() ? "frequency event," : ", frequency", change);
  return text.empty() ? "no switching" : text;
}

std::string quiet_end_hint(const EventComparison& e) {
  if (e.switchings.empty()) return {};
  const double over = e.switchings.back().time, quiet = e.record.t.back() - over;
  if (quiet < kQuietTime) return {};
  return fmt::format(
      "The record continues for {:.0f} s after the last switching: errors over the whole "
      "record are averaged over this quiet time. --until {:.0f} limits them to the event.",
      quiet, std::ceil(over + kQuietTime / 4));
}

}  // namespace swingbank::validate::compare
