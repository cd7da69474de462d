// A steady oscillation in what a fit leaves.
#include "validate/fit/lines.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::fit {
namespace {

constexpr double kHighestLine = 5.0;  ///< [Hz]; beyond it nothing of a plant swings for long
constexpr double kOfNyquist = 0.8;    ///< an instrument's filter takes what lies above
constexpr int kFewestPeriods = 2;     ///< in the longest record
constexpr int kPerResolved = 2;       ///< frequencies looked at for each that can be told apart

/// chi2 that a wave of this frequency takes off a whitened residual; 2 of noise.
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

Line strongest_line(const Fit& fit, const event::WhitenedEvents& events) {
  double longest = 0, highest = kHighestLine;
  for (const event::FitEvent& e : events) {
    longest = std::max(longest, e.record.t.back() - e.record.t.front());
    highest = std::min(highest, kOfNyquist / (2 * e.record.step()));
  }
  const double lowest = kFewestPeriods / longest, apart = 1 / (kPerResolved * longest);
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
          explains += taken_off(fit.events[e].residual[c], frequency * events[e].record.step()) -
                      2 * thresholds::adequacy.number;
      if (explains > best.explains) best = {channels[c], frequency, explains};
    }
  return best;
}

}  // namespace swingbank::validate::fit
