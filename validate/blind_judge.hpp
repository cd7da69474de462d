#pragma once
// Our own diagnosis as the judge of a blind test.
#include "validate/blind_verdict.hpp"
#include "validate/diagnose.hpp"

namespace swingbank::validate {

/// Reads model.toml and every event*.csv of a case folder and diagnoses them. What the diagnosis refuses
/// (InputError) is the verdict `refused`.
BlindJudge diagnosis_judge(const DiagnoseOptions& options = {});

}  // namespace swingbank::validate
