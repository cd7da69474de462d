#include "validate/playin/instants.hpp"

#include <cmath>
#include <complex>

namespace swingbank::validate::playin {

std::vector<Complex> voltage_steps(const record::Record& record) {
  const auto phasor = [&](std::size_t k) { return std::polar(record.V[k], record.theta[k]); };
  std::vector<Complex> step;
  for (std::size_t k = 0; k + 1 < record.t.size(); ++k) step.push_back(phasor(k + 1) - phasor(k));
  return step;
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
