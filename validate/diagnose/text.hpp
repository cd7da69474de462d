#pragma once
// Terminal report of a diagnosis: verdict, inferred inputs, leading hypotheses, and fitted parameters.
#include <string>

#include "validate/diagnose/diagnose.hpp"

namespace swingbank::validate::diagnose {

/// Returns the diagnosis as text.
std::string diagnosis_text(const Diagnosis& diagnosis);
/// Returns every threshold of a verdict with value, unit and reason.
std::string thresholds_text();

}  // namespace swingbank::validate::diagnose
