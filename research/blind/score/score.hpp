#pragma once
// Score of a blind run: hit rates of the verdicts against the truth, with 95 % intervals.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "base/rate.hpp"
#include "research/blind/score/reliability.hpp"
#include "research/blind/score/verdict.hpp"

namespace swingbank::research::blind::score {

/// Truth and verdict of one case.
struct ScoredCase {
  std::string name;
  std::vector<std::string> kinds, sides;                 ///< of the hidden effects
  std::vector<std::vector<std::string>> accepted_names;  ///< accepted names per hidden effect
  bool listed = true;                                    ///< every hidden effect is in the list of hypotheses
  bool value = false;                   ///< nothing is missing, but a value of the model is wrong
  double size = 0;                      ///< smallest size of the hidden effects [detection limits]
  bool channels = false;                ///< speed and Ifd are recorded
  std::vector<std::string> conditions;  ///< names of the recording conditions
  BlindVerdict verdict;

  [[nodiscard]] bool first_right() const;      ///< the first effect named is a hidden one
  [[nodiscard]] bool right_or_in_set() const;  ///< first_right(), or the confusion set contains it
  [[nodiscard]] bool all_named() const;        ///< every hidden effect is named
  [[nodiscard]] bool all_in_set() const;       ///< all_named(), or one set entry ("A + B") names every one
  [[nodiscard]] bool side_right() const;
  [[nodiscard]] bool nothing_missing() const { return kinds.empty() || value; }
  [[nodiscard]] bool values_named()
      const;  ///< nothing is missing, and the wrong values are among those named
  /// Returns the verdict's probabilities with the truth. An explanation is correct if it names every hidden
  /// effect and nothing else.
  [[nodiscard]] Forecast forecast() const;
};

/// Hit rates of the cases under one recording condition; single effects count from 2 detection limits up.
struct ByCondition {
  Rate nothing;  ///< nothing hidden: verdict adequate
  Rate one;      ///< one listed effect: named first or in the set
  Rate value;    ///< wrong value: named
  Rate outside;  ///< unlisted effect: verdict "none of these"
};

struct BlindScore {
  std::vector<ScoredCase> cases;
  std::vector<std::string> unjudged;  ///< cases without a verdict
  std::map<std::string, Rate> rates;  ///< by name, see score_blind()
  std::map<std::string, double> targets;
  std::map<std::string, std::map<std::string, int>> confusion;  ///< counts [kind][first effect named]
  std::map<std::string, std::vector<Rate>> by_size;             ///< by channels: first_right() per size class
  std::map<std::string, ByCondition> by_condition;
  Reliability reliability;
  double median_seconds = 0, longest_seconds = 0;
};
/// Lower edges of the size classes [detection limits].
inline constexpr double kSizeEdges[] = {0.0, 1.0, 2.0, 4.0, 7.0};

/// Scores the truth and the verdicts of the folder `run`. `targets` is a TOML file whose [target] holds least
/// rates by name. Throws InputError with every error of the files.
BlindScore score_blind(const std::filesystem::path& run, const std::filesystem::path& targets);
std::string score_markdown(const BlindScore& score);
nlohmann::json score_json(const BlindScore& score);

}  // namespace swingbank::research::blind::score
