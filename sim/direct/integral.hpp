#pragma once
// Running integrals of sampled signals, and where a record is smooth.
#include <Eigen/Core>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// Integral from the first sample to each; exact for a cubic through four neighbours, so that the error is of
/// order step^4. Zero where there are fewer than four samples.
Eigen::VectorXd integral(const Eigen::VectorXd& f, double step);

/// A smooth stretch of fewer samples says too little.
constexpr std::size_t kShortestStretch = 40;
/// A leap of the voltage is a step between two samples of more than this [pu]: a fifth of the record's
/// largest step and of 0.01 pu, and more than the record's noise makes.
double leap_limit(const Recording& record);
/// First sample behind the last leap; 0 if nothing leaps.
std::size_t behind_last_leap(const Recording& record);
/// How many samples lie before the first leap; all if nothing leaps.
std::size_t before_first_leap(const Recording& record);

}  // namespace swingbank::sim::direct
