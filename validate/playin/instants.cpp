#include "validate/playin/instants.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace swingbank::validate::playin {

std::vector<Complex> voltage_steps(const record::Record& record) {
  const auto phasor = [&](std::size_t k) { return std::polar(record.V[k], record.theta[k]); };
  std::vector<Complex> step;
  for (std::size_t k = 0; k + 1 < record.t.size(); ++k) step.push_back(phasor(k + 1) - phasor(k));
  return step;
}

std::vector<double> spikes(const record::Record& record) {
  const std::vector<Complex> step = voltage_steps(record);
  std::vector<double> spike(step.size(), 0.0);
  for (std::size_t k = 1; k + 1 < step.size(); ++k)
    spike[k] = std::min(std::abs(step[k] - step[k - 1]), std::abs(step[k] - step[k + 1]));
  return spike;
}

Switching within_step(const record::Record& record, std::size_t k) {
  const double half = (record.t[k + 1] - record.t[k]) / 2;
  return {.time = record.t[k] + half, .uncertainty = half};
}

std::vector<Switching> lone_jumps(const record::Record& record, double threshold) {
  constexpr double kOfThreshold = 0.05, kOfNext = 5;
  constexpr std::size_t kAround = 10;
  const auto spike = spikes(record);
  const auto is_lone = [&](std::size_t k) {
    if (spike[k] <= kOfThreshold * threshold) return false;
    for (std::size_t j = k - kAround; j <= k + kAround; ++j)
      if (j != k && spike[k] <= kOfNext * spike[j]) return false;
    return true;
  };
  std::vector<Switching> found;
  for (std::size_t k = kAround; k + kAround < spike.size(); ++k)
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
