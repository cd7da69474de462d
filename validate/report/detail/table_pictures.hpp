#pragma once
// Plots of a task: error of each method, error per parameter, and reliability of the intervals.
#include <string>

#include "validate/report/detail/summary.hpp"

namespace swingbank::validate::report {

/// Raw MSE of each method per noise level: the mean as a large mark, each generator as a small mark.
std::string method_picture(const Task& task);
/// Relative error of each parameter: one panel per noise level, one mark per method.
std::string parameter_picture(const Task& task);
/// Observed against nominal coverage of the methods' intervals; empty if no method gave intervals.
std::string reliability_picture(const Task& task);

}  // namespace swingbank::validate::report
