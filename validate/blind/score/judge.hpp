#pragma once
// Our own diagnosis as the judge of a blind test.
#include <filesystem>
#include <vector>

#include "validate/blind/score/verdict.hpp"
#include "validate/diagnose/diagnose.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::blind::score {

/// What a judge may see of a case: the owner's model and the records of its events.
struct SeenCase {
  plant::PlantModel model;
  std::vector<record::Record> records;
};
/// From model.toml and every event*.csv of a case folder. Throws InputError.
SeenCase read_seen_case(const std::filesystem::path& folder);

/// Diagnoses what stands in a case folder. What the diagnosis refuses
/// (InputError) is the verdict `refused`.
BlindJudge diagnosis_judge(const diagnose::DiagnoseOptions& options = {});

}  // namespace swingbank::validate::blind::score
