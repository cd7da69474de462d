#pragma once
// Judge of a blind test that uses Swingbank's diagnosis.
#include <filesystem>
#include <vector>

#include "research/blind/score/verdict.hpp"
#include "validate/diagnose/diagnose.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"

namespace swingbank::research::blind::score {

/// Input of a judge: the owner's model and the records of its events.
struct SeenCase {
  validate::plant::PlantModel model;
  std::vector<validate::record::Record> records;
};
/// Reads model.toml, point.toml if it exists, and every *.csv of a case folder. Throws InputError on invalid
/// files.
SeenCase read_seen_case(const std::filesystem::path& folder);

/// Returns a judge that diagnoses a case folder. If the diagnosis throws InputError, the verdict is
/// `refused`.
BlindJudge diagnosis_judge(const validate::diagnose::DiagnoseOptions& options = {});

}  // namespace swingbank::research::blind::score
