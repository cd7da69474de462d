#pragma once
// Verdict on a blind case, and the interface of a judge.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/json.hpp"

namespace swingbank::research::blind::score {

struct BlindVerdict {
  std::string verdict;                  ///< adequate, missing, confusable, unexplained or refused
  std::vector<std::string> effects;     ///< missing effects, most probable first
  std::vector<std::string> set;         ///< effects that the records do not distinguish
  std::string side = "none";            ///< mechanical, excitation, machine, measurement or none
  double seconds = 0;                   ///< wall-clock time [s]
  std::string why = {};                 ///< optional: reason as a sentence
  std::vector<std::string> wrong = {};  ///< optional: names of wrong values, as "GENROU.H"
  /// Optional: probability of each explanation, the most probable first. Names are "SEXS", "A + B",
  /// validate::hypothesis::kNothingMissing or validate::hypothesis::kNoneOfThese.
  std::vector<std::pair<std::string, double>> probabilities = {};
  nlohmann::json basis = {};  ///< optional: numbers on which the verdict depends; copied unchanged
};

/// Function that judges a case folder (model.toml, event1.csv ...), which does not contain the truth.
using BlindJudge = std::function<BlindVerdict(const std::filesystem::path& folder)>;

/// Reads a verdict's JSON: the keys verdict, effects, set, side and seconds, and the optional keys wrong,
/// why, probabilities and basis. Throws InputError with every error.
BlindVerdict read_verdict(const std::filesystem::path& file);
std::string verdict_json(const BlindVerdict& verdict);

/// Returns a judge that runs `program CASE_FOLDER VERDICT_FILE` and reads the file that the program writes in
/// the folder `work`. The judge throws InputError if the program fails.
BlindJudge program_judge(const std::string& program, const std::filesystem::path& work);

/// Judges every case of RUN/cases that belongs to part K of N (`part`, K from 1) and has no
/// RUN/verdicts/<case>.json yet. Calls progress(case, verdict) after each. If the judge throws InputError,
/// the case gets no verdict. Returns these errors.
std::vector<std::string> judge_cases(
    const std::filesystem::path& run, const BlindJudge& judge, std::pair<int, int> part,
    const std::function<void(const std::string&, const BlindVerdict&)>& progress);

}  // namespace swingbank::research::blind::score
