#pragma once
// What a diagnosis said of a blind case, and the seam through which one is asked.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/json.hpp"

namespace swingbank::validate::blind::score {

struct BlindVerdict {
  std::string verdict;                  ///< adequate, missing, confusable, unexplained or refused
  std::vector<std::string> effects;     ///< what is missing, best first; several where several are missing
  std::vector<std::string> set;         ///< names that cannot be told apart
  std::string side = "none";            ///< mechanical, excitation, machine, measurement or none
  double seconds = 0;                   ///< wall time it took [s]
  std::string why = {};                 ///< optional: the sentence behind it
  std::vector<std::string> wrong = {};  ///< optional: values that are wrong, as "GENROU.H"
  /// optional: of each explanation, the most probable first ("SEXS", "A + B", hypothesis::kNothingMissing,
  /// hypothesis::kNoneOfThese)
  std::vector<std::pair<std::string, double>> probabilities = {};
  nlohmann::json basis = {};  ///< optional, kept as it is: what the verdict rests on
};

/// Gets a case folder (model.toml, event1.csv ...), which holds nothing of the truth.
using BlindJudge = std::function<BlindVerdict(const std::filesystem::path& folder)>;

/// Reads a verdict's JSON: the keys verdict, effects, set, side, seconds and, if there, wrong, why,
/// probabilities and basis. Throws InputError with every fault.
BlindVerdict read_verdict(const std::filesystem::path& file);
std::string verdict_json(const BlindVerdict& verdict);

/// A judge that runs `program CASE_FOLDER VERDICT_FILE` and reads the file it writes; `work` is a folder for
/// that file. The judge throws InputError where the program fails.
BlindJudge program_judge(const std::string& program, const std::filesystem::path& work);

/// Judges every case of RUN/cases that has no RUN/verdicts/<case>.json yet and belongs to part K of N (from
/// 1), and tells `progress` (case, verdict) after each. A case whose judge throws is left without a verdict.
/// Returns the faults.
std::vector<std::string> judge_cases(
    const std::filesystem::path& run, const BlindJudge& judge, std::pair<int, int> part,
    const std::function<void(const std::string&, const BlindVerdict&)>& progress);

}  // namespace swingbank::validate::blind::score
