#pragma once
// Least-squares regression of every signal of a record on every pair of the other signals. Constants of a
// system of linear differential equations show in these coefficients, independent of operating point and
// fault. The method uses no machine model.
#include <cstddef>
#include <span>

namespace swingbank::train::data {

/// Returns the number of coefficients: two for each signal and pair of others.
constexpr std::size_t regression_count(std::size_t signals) {
  return signals < 3 ? 0 : signals * (signals - 1) * (signals - 2);
}

/// Computes regression_count(signals) coefficients `out`, in units of the signal per unit of the regressor.
/// series: signals x weights.size(); weights: of the samples, > 0. Signals are taken relative to their means.
/// A ridge of one millionth keeps the coefficients of collinear pairs finite.
void regress(const float* series, std::size_t signals, std::span<const float> weights, float* out);

}  // namespace swingbank::train::data
