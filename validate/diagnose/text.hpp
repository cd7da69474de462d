#pragma once
// A diagnosis for a terminal: the verdict, the inferred inputs, and every hypothesis that was fitted.
#include <string>

#include "validate/diagnose/diagnose.hpp"

namespace swingbank::validate::diagnose {

std::string diagnosis_text(const Diagnosis& diagnosis);

}  // namespace swingbank::validate::diagnose
