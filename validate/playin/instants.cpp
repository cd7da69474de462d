#include "validate/playin/instants.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace swingbank::validate::playin {
namespace {

/// How far each step lies from the straight lines through the two steps before and the two after it, the
/// nearer of them [pu]: a jump stands out from both, the step beside it from one, a rotor's swing from none.
std::vector<double> standing_out(const std::vector<Complex>& step) {
  std::vector<double> out(step.size(), 0.0);
  for (std::size_t k = 2; k + 2 < step.size(); ++k)
    out[k] = std::min(std::abs(step[k] - 2.0 * step[k - 1] + step[k - 2]),
                      std::abs(step[k] - 2.0 * step[k + 1] + step[k + 2]));
  return out;
}

}  // namespace

std::vector<Complex> voltage_steps(const record::Record& record) {
  const auto phasor = [&](std::size_t k) { return std::polar(record.V[k], record.theta[k]); };
  std::vector<Complex> step;
  for (std::size_t k = 0; k + 1 < record.t.size(); ++k) step.push_back(phasor(k + 1) - phasor(k));
  return step;
}

Switching within_step(const record::Record& record, std::size_t k) {
  const double half = (record.t[k + 1] - record.t[k]) / 2;
  return {.time = record.t[k] + half, .uncertainty = half};
}

std::vector<Switching> lone_jumps(const record::Record& record, double threshold) {
  constexpr double kOfThreshold = 0.05, kOfAround = 5;
  constexpr std::size_t kAround = 10, kSamplesBefore = 4;  // the record may begin just before the event
  const auto out = standing_out(voltage_steps(record));
  const auto is_lone = [&](std::size_t k) {
    if (out[k] <= kOfThreshold * threshold) return false;
    for (std::size_t j = k > kAround ? k - kAround : 0; j <= k + kAround; ++j)
      if (j != k && out[k] <= kOfAround * out[j]) return false;
    return true;
  };
  std::vector<Switching> found;
  for (std::size_t k = kSamplesBefore; k + kAround < out.size(); ++k)
    if (is_lone(k)) found.push_back(within_step(record, k));
  return found;
}

std::size_t leaves(std::span<const double> signal, const Leaving& rule) {
  std::size_t off = 0;
  for (std::size_t k = rule.from; k < signal.size(); ++k) {
    off = std::abs(signal[k] - rule.level) > rule.reach ? off + 1 : 0;
    if (off == rule.in_a_row) return k + 1 - rule.in_a_row;
  }
  return signal.size();
}

}  // namespace swingbank::validate::playin
