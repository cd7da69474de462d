#include "validate/record/detail/phasor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/constants.hpp"

namespace swingbank::validate::record {
namespace {

using Complex = std::complex<double>;

/// One phase over the window from `from` to `to` [s].
Complex fourier(const std::vector<double>& samples, double rate, double skew, double omega, double from,
                double to) {
  const double half = 0.5 / rate;
  const auto last = static_cast<long>(samples.size()) - 1;
  const auto first_k = std::clamp<long>(static_cast<long>(std::floor((from - half) * rate)), 0, last);
  const auto last_k = std::clamp<long>(static_cast<long>(std::ceil((to + half) * rate)), 0, last);
  Complex sum = 0;
  for (long k = first_k; k <= last_k; ++k) {
    const double t = static_cast<double>(k) / rate;
    const double inside = std::min(t + half, to) - std::max(t - half, from);
    if (inside > 0)
      sum += inside * samples[static_cast<std::size_t>(k)] * std::polar(1.0, -omega * (t + skew));
  }
  return sum * std::numbers::sqrt2 / (to - from);
}

}  // namespace

PhasorTrack positive_sequence(const Waveforms& waves, double nominal, double phasors_per_second) {
  PhasorTrack track;
  const double omega = constants::turn * nominal, cycle = 1 / nominal;
  const auto n = std::min({waves.samples[0].size(), waves.samples[1].size(), waves.samples[2].size()});
  if (n == 0) return track;
  const double end = (static_cast<double>(n) - 0.5) / waves.rate;
  const Complex turn = std::polar(1.0, constants::turn / 3), turns[] = {1.0, turn, turn * turn};
  for (std::size_t j = 0;; ++j) {
    const double middle = (cycle - 1 / waves.rate) / 2 + static_cast<double>(j) / phasors_per_second;
    if (middle + cycle / 2 > end + 1e-9) return track;
    Complex x = 0;
    for (std::size_t p = 0; p < 3; ++p)
      x +=
          turns[p] / 3.0 *
          fourier(waves.samples[p], waves.rate, waves.skew[p], omega, middle - cycle / 2, middle + cycle / 2);
    track.t.push_back(middle);
    track.x.push_back(x);
  }
}

}  // namespace swingbank::validate::record
