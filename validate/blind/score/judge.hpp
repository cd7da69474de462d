#pragma once
// Our own diagnosis as the judge of a blind test.
#include "validate/blind/score/verdict.hpp"
#include "validate/diagnose/diagnose.hpp"

namespace swingbank::validate::blind::score {

/// Reads model.toml and every event*.csv of a case folder and diagnoses them. What the diagnosis refuses
/// (InputError) is the verdict `refused`.
BlindJudge diagnosis_judge(const diagnose::DiagnoseOptions& options = {});

}  // namespace swingbank::validate::blind::score
