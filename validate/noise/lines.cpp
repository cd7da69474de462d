// Detection of a steady oscillation in a fit's residual.
#include "validate/noise/lines.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::noise {
namespace {

constexpr double kHighestLine = 5.0;  ///< [Hz]; faster oscillations of a plant are damped quickly
constexpr double kOfNyquist = 0.8;    ///< share of the Nyquist frequency above which instruments filter
constexpr int kMinPeriods = 2;        ///< minimum number of periods in the longest record
constexpr int kPerResolved = 2;       ///< number of examined frequencies per resolvable one

/// Returns the reduction of chi2 if a sine of this frequency is subtracted from a whitened residual; 2 on
/// average for white noise.
double taken_off(const std::vector<double>& residual, double turns_per_sample) {
  const Complex turn = std::polar(1.0, constants::turn * turns_per_sample);
  Complex sum = 0, phasor = 1;
  int compared = 0;
  for (const double r : residual) {
    sum += r * phasor;
    phasor *= turn;
    compared += r != 0.0;
  }
  return compared > 0 ? 2 * std::norm(sum) / compared : 0.0;
}

}  // namespace

Line strongest_line(const std::vector<EventFit>& fits, const WhitenedEvents& events) {
  double longest = 0, highest = kHighestLine;
  for (const event::FitEvent& e : events) {
    longest = std::max(longest, e.record.t.back() - e.record.t.front());
    highest = std::min(highest, kOfNyquist / (2 * e.record.step()));
  }
  const double lowest = kMinPeriods / longest, apart = 1 / (kPerResolved * longest);
  const int frequencies = static_cast<int>(std::floor((highest - lowest) / apart)) + 1;
  const auto& channels = events.front().channels;
  Line best;
  if (frequencies < 1) return best;
  const double choice = 2 * std::log(static_cast<double>(frequencies) * static_cast<double>(channels.size()));
  best.explains = -choice;
  for (std::size_t c = 0; c < channels.size(); ++c)
    for (int k = 0; k < frequencies; ++k) {
      const double frequency = lowest + k * apart;
      double explains = -choice;
      for (std::size_t e = 0; e < events.size(); ++e)
        if (events[e].channels == channels)
          explains += taken_off(fits[e].residual[c], frequency * events[e].record.step()) -
                      2 * thresholds::adequacy.number;
      if (explains > best.explains) best = {channels[c], frequency, explains};
    }
  return best;
}

}  // namespace swingbank::validate::noise
