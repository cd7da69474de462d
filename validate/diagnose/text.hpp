#pragma once
// A diagnosis for a terminal: the verdict, the inferred inputs, and every hypothesis that was fitted.
#include <string>

#include "validate/diagnose/diagnose.hpp"

namespace swingbank::validate::diagnose {

std::string diagnosis_text(const Diagnosis& diagnosis);
/// Every threshold of a verdict with value, unit and why.
std::string thresholds_text();

}  // namespace swingbank::validate::diagnose
