#pragma once
// Least-squares regression of every signal of a record on every pair of the other signals. If the signals
// obey linear differential equations, the coefficients depend on the constants of these equations, but not on
// operating point and fault. The method uses no machine model.
#include <cstddef>
#include <span>

namespace swingbank::train::data {

/// Returns the number of coefficients: two for each signal and pair of other signals.
constexpr std::size_t regression_count(std::size_t signals) {
  return signals < 3 ? 0 : signals * (signals - 1) * (signals - 2);
}

/// Computes regression_count(signals) coefficients `out`, in units of the signal per unit of the regressor.
/// series: signals x weights.size(); weights: positive weights of the samples. The means of the signals are
/// subtracted first. A small ridge keeps the coefficients of collinear pairs finite.
void regress(const float* series, std::size_t signals, std::span<const float> weights, float* out);

}  // namespace swingbank::train::data
