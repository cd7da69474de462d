#pragma once
// Every signal of a record regressed on every pair of the others, by least squares over the record: what is
// constant in a system of linear differential equations shows in such coefficients, whatever the operating
// point and the fault. Nothing in it knows a machine.
#include <cstddef>
#include <span>

namespace swingbank::train::data {

/// Coefficients for so many signals: two for each signal and pair of others.
constexpr std::size_t regression_count(std::size_t signals) {
  return signals < 3 ? 0 : signals * (signals - 1) * (signals - 2);
}

/// series: signals x weights.size(); weights: of the samples, above 0; out: regression_count(signals)
/// numbers, in units of the signal over those of the other. Each signal is taken about its mean. A pair that
/// says one and the same is held apart by a millionth of its size, so that no coefficient is infinite.
void regress(const float* series, std::size_t signals, std::span<const float> weights, float* out);

}  // namespace swingbank::train::data
