#pragma once
// Running integrals of sampled signals, and where a record is smooth.
#include <Eigen/Core>
#include <span>

namespace swingbank::sim::direct {

/// Integral from the first sample to each; exact for a cubic through four neighbours, so that the error is of
/// order step^4. Zero where there are fewer than four samples.
Eigen::VectorXd integral(const Eigen::VectorXd& f, double step);

/// A smooth stretch of fewer samples says too little.
constexpr std::size_t kShortestStretch = 40;
/// First sample behind the last leap of the voltage V [pu]: behind the last interval whose step is more than
/// a fifth of the largest one and of 0.01 pu. 0 if nothing leaps.
std::size_t behind_last_leap(std::span<const double> V);

/// How many samples lie before the first such leap; all if nothing leaps.
std::size_t before_first_leap(std::span<const double> V);

}  // namespace swingbank::sim::direct
