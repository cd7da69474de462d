#pragma once
// A task's figures as pictures: methods beside the thesis, errors per parameter, reliability.
#include <string>

#include "validate/report/detail/summary.hpp"

namespace swingbank::validate::report {

/// Raw MSE of each method at each level of noise: the mean as a large mark, each generator as a small one.
std::string method_picture(const Task& task);
/// Relative error of each parameter, one panel per level of noise, one mark per method.
std::string parameter_picture(const Task& task);
/// How often the truth lay in the intervals that the methods gave, against how often it should; empty where
/// none gave any.
std::string reliability_picture(const Task& task);

}  // namespace swingbank::validate::report
