#pragma once
// The score of a blind run: verdicts against the sealed truth, as rates with their 95 % intervals.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "base/rate.hpp"
#include "validate/blind/score/reliability.hpp"
#include "validate/blind/score/verdict.hpp"

namespace swingbank::validate::blind::score {

/// One case: what was hidden and what was said.
struct ScoredCase {
  std::string name;
  std::vector<std::string> kinds, sides;          ///< of the hidden effects
  std::vector<std::vector<std::string>> answers;  ///< names that count as right, per hidden effect
  bool listed = true;                             ///< every hidden effect is in the list of hypotheses
  bool value = false;                             ///< nothing is missing: a value of the model is wrong
  double size = 0;                                ///< smallest of the hidden effects, in detection limits
  bool channels = false;                          ///< speed and Ifd measured too
  std::vector<std::string> conditions;            ///< what the case was recorded under, in words
  BlindVerdict verdict;

  [[nodiscard]] bool first_right() const;      ///< the first effect named is the hidden one
  [[nodiscard]] bool right_or_in_set() const;  ///< or it is in the stated confusion set
  [[nodiscard]] bool all_named() const;        ///< every hidden effect is named
  [[nodiscard]] bool all_in_set() const;       ///< or one entry of the stated set ("A + B") names every one
  [[nodiscard]] bool side_right() const;
  [[nodiscard]] bool nothing_missing() const { return kinds.empty() || value; }
  [[nodiscard]] bool values_named()
      const;  ///< nothing is missing, and the wrong values are among those named
  /// The verdict's probabilities against the truth: right is the explanation that names all that is hidden,
  /// and nothing else.
  [[nodiscard]] Forecast forecast() const;
};

/// What was right of the cases that were recorded under one condition; of single effects from 2 limits up.
struct ByCondition {
  Rate nothing;  ///< nothing hidden: adequate
  Rate one;      ///< one listed effect: first, or in the set
  Rate value;    ///< a wrong value: named
  Rate outside;  ///< outside the list: none of these
};

struct BlindScore {
  std::vector<ScoredCase> cases;
  std::vector<std::string> unjudged;  ///< cases without a verdict
  std::map<std::string, Rate> rates;  ///< by name: see score_blind
  std::map<std::string, double> targets;
  std::map<std::string, std::map<std::string, int>> confusion;  ///< [kind][what was said first]
  std::map<std::string, std::vector<Rate>> by_size;             ///< "PQ", "all": right first, per size class
  std::map<std::string, ByCondition> by_condition;
  Reliability reliability;
  double median_seconds = 0, longest_seconds = 0;
};
/// Lower edges of the size classes [detection limits].
inline constexpr double kSizeEdges[] = {0.0, 1.0, 2.0, 4.0, 7.0};

/// Reads RUN/truth and RUN/verdicts. `targets` (a TOML file's [target]) sets a least rate for each rate it
/// names. Throws InputError with every fault of the files.
BlindScore score_blind(const std::filesystem::path& run, const std::filesystem::path& targets);
std::string score_markdown(const BlindScore& score);
nlohmann::json score_json(const BlindScore& score);

}  // namespace swingbank::validate::blind::score
