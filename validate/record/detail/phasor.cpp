#include "validate/record/detail/phasor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/constants.hpp"

namespace swingbank::validate::record {
namespace {

using Complex = std::complex<double>;

/// Returns the phasor of one phase over the window from `from` to `to` [s].
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

constexpr double kThird = constants::turn / 3;

/// Summed magnitudes of positive and negative sequence, with the phases multiplied by given factors.
struct Sequences {
  double positive = 0, negative = 0;
};
Sequences sequences(const std::array<std::vector<Complex>, 3>& x, const std::array<Complex, 3>& factor) {
  Sequences sums;
  for (std::size_t k = 0; k < x[0].size(); ++k) {
    const Complex a = factor[0] * x[0][k], b = factor[1] * x[1][k], c = factor[2] * x[2][k];
    if (!std::isfinite(std::norm(a + b + c))) continue;
    sums.positive += std::abs(a + std::polar(1.0, kThird) * b + std::polar(1.0, -kThird) * c);
    sums.negative += std::abs(a + std::polar(1.0, -kThird) * b + std::polar(1.0, kThird) * c);
  }
  return sums;
}

}  // namespace

PhasorTrack phase_phasors(const Waveforms& waves, double nominal, double phasors_per_second) {
  PhasorTrack track;
  const double omega = constants::turn * nominal, cycle = 1 / nominal;
  const auto n = std::min({waves.samples[0].size(), waves.samples[1].size(), waves.samples[2].size()});
  if (n == 0) return track;
  const double end = (static_cast<double>(n) - 0.5) / waves.rate;
  for (std::size_t j = 0;; ++j) {
    const double middle = (cycle - 1 / waves.rate) / 2 + static_cast<double>(j) / phasors_per_second;
    if (middle + cycle / 2 > end + 1e-9) return track;
    track.t.push_back(middle);
    for (std::size_t p = 0; p < 3; ++p)
      track.x[p].push_back(fourier(waves.samples[p], waves.rate, waves.skew[p], omega, middle - cycle / 2,
                                   middle + cycle / 2));
  }
}

Complex positive_sequence(const std::array<Complex, 3>& x, bool between) {
  const Complex sum = x[0] + std::polar(1.0, kThird) * x[1] + std::polar(1.0, -kThird) * x[2];
  return between ? sum * std::polar(1 / (3 * std::numbers::sqrt3), -constants::turn / 12) : sum / 3.0;
}

std::optional<SequenceFault> sequence_fault(const std::array<std::vector<Complex>, 3>& x,
                                            const std::array<std::string, 3>& names) {
  const Sequences as_is = sequences(x, {1.0, 1.0, 1.0});
  if (as_is.positive >= as_is.negative) return std::nullopt;
  const std::string why = fmt::format("of {}, {}, {} the negative sequence is larger than the positive one",
                                      names[0], names[1], names[2]);
  for (std::size_t p = 0; p < 3; ++p) {  // a reversed phase reduces the positive sequence to a third
    std::array<Complex, 3> factor{1.0, 1.0, 1.0};
    factor[p] = -1.0;
    if (const Sequences s = sequences(x, factor); s.positive > 4 * s.negative)
      return SequenceFault{
          fmt::format("{} has the opposite sign of {} and {}", names[p], names[(p + 1) % 3],
                      names[(p + 2) % 3]),
          why,
          fmt::format("reverse the sign of {}, because the leads of this phase are exchanged", names[p])};
  }
  return SequenceFault{
      "phase sequence is A-C-B", why,
      fmt::format(
          "exchange the names of {} and {}, because two leads are exchanged; if the grid has phase sequence "
          "A-C-B, exchange these names for both voltages and currents",
          names[1], names[2])};
}

}  // namespace swingbank::validate::record
