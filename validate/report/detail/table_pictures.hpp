#pragma once
// Plots of a task: error of each method, learning curves, estimates against truth, error per parameter, and
// reliability of the intervals.
#include <string>

#include "validate/report/detail/summary.hpp"

namespace swingbank::validate::report {

/// Raw MSE of each method per noise level: the mean as a large mark, each generator as a small mark.
std::string method_picture(const Task& task);
/// Validation error of each trained network against the epoch, at its lowest noise level: mean over the runs.
/// Empty if no run has a curve.
std::string curve_picture(const Task& task);
/// Estimates against true values without noise, one panel for each of the parameters with the largest
/// variance: the thesis's network with the lowest MSE, and the trained network with the lowest MSE. Empty if
/// no run lists estimates.
std::string truth_picture(const Task& task);
/// Relative error of each parameter: one panel per noise level, one mark per method.
std::string parameter_picture(const Task& task);
/// Observed against nominal coverage of the methods' intervals; empty if no method gave intervals.
std::string reliability_picture(const Task& task);

}  // namespace swingbank::validate::report
