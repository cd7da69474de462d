#pragma once
// Score of a blind run: hit rates of the verdicts, with 95 % intervals.
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
  std::vector<std::string> kinds, sides;                 ///< kinds and sides of the hidden effects
  std::vector<std::vector<std::string>> accepted_names;  ///< accepted names per hidden effect
  bool listed = true;                                    ///< whether hypotheses cover every hidden effect
  bool value = false;                                    ///< whether only a value of the model is wrong
  double size = 0;                      ///< smallest size of the hidden effects [detection limits]
  bool channels = false;                ///< whether speed and Ifd are recorded
  std::vector<std::string> conditions;  ///< names of the recording conditions
  BlindVerdict verdict;

  [[nodiscard]] bool first_right() const;      ///< whether the first named effect is a hidden one
  [[nodiscard]] bool right_or_in_set() const;  ///< first_right(), or the set contains a hidden effect
  [[nodiscard]] bool all_named() const;        ///< whether every hidden effect is named
  [[nodiscard]] bool all_in_set() const;       ///< all_named(), or one entry of the set ("A + B") names all
  [[nodiscard]] bool side_right() const;
  [[nodiscard]] bool nothing_missing() const { return kinds.empty() || value; }
  [[nodiscard]] bool values_named() const;  ///< whether nothing is missing and all wrong values are named
  /// Returns the verdict's probabilities, compared with the truth. An explanation is true if it names every
  /// hidden effect and nothing else. For an unlisted disturbance, "none of these" is true. Explanations
  /// without a missing effect count as one, which is true if nothing is missing.
  [[nodiscard]] Forecast forecast() const;
};

/// Hit rates of the cases under one field condition. Single effects count if their size is at least 2
/// detection limits.
struct ByCondition {
  Rate nothing;  ///< nothing hidden: the verdict is "adequate"
  Rate one;      ///< one listed effect: it is named first or in the set
  Rate value;    ///< wrong value: it is named
  Rate outside;  ///< unlisted disturbance: the verdict is "unexplained"
};

struct BlindScore {
  std::vector<ScoredCase> cases;
  std::vector<std::string> unjudged;  ///< cases without a verdict
  std::map<std::string, Rate> rates;  ///< hit rates by name
  std::map<std::string, double> targets;
  std::map<std::string, std::map<std::string, int>>
      confusion;  ///< cases by hidden kind, and by first named effect or else verdict
  std::map<std::string, std::vector<Rate>> by_size;  ///< first_right() per size class, by recorded channels
  std::map<std::string, ByCondition> by_condition;
  Reliability reliability;
  double median_seconds = 0, longest_seconds = 0;
};
/// Lower edges of the size classes [detection limits].
inline constexpr double kSizeEdges[] = {0.0, 1.0, 2.0, 4.0, 7.0};

/// Compares the verdicts of the folder `run` with the truth. `targets`: TOML file whose [target] contains the
/// required rates by name. Throws InputError with every error of the files.
BlindScore score_blind(const std::filesystem::path& run, const std::filesystem::path& targets);
std::string score_markdown(const BlindScore& score);
nlohmann::json score_json(const BlindScore& score);

}  // namespace swingbank::research::blind::score
