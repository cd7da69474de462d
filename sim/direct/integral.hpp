#pragma once
// Running integrals of sampled signals, and steps of a record's voltage.
#include <Eigen/Core>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// Returns the integral from the first sample to each sample. Exact for cubics, so that the error is of
/// order step^4. Zero for fewer than four samples.
Eigen::VectorXd integral(const Eigen::VectorXd& f, double step);

/// Least number of samples of a smooth segment. Shorter segments contain too little information.
constexpr std::size_t kShortestStretch = 40;
/// Returns the change of the voltage between two samples [pu] above which it is a step. It is a fifth of the
/// largest such change of the record, but at least 0.002 pu and 6 standard deviations of the difference of
/// two noisy samples.
double leap_limit(const Recording& record);
/// Returns the first sample after the last voltage step; 0 if there is none.
std::size_t behind_last_leap(const Recording& record);
/// Returns the number of samples before the first voltage step; all if there is none.
std::size_t before_first_leap(const Recording& record);

}  // namespace swingbank::sim::direct
