#pragma once
// Reliability of the diagnosis's probabilities: of all explanations with a probability of 80 %, four in five
// should be correct.
#include <cstddef>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "base/rate.hpp"

namespace swingbank::research::blind::score {

/// Probabilities of one verdict, compared with the truth.
struct Forecast {
  std::string group;                  ///< group of records, such as "P, Q only"
  std::vector<double> probabilities;  ///< one per explanation, the most probable first
  std::vector<char> right;            ///< per explanation: whether it is true
  bool listed = false;                ///< whether the truth is a single listed effect
};

/// Edges of the diagram's probability bins.
inline constexpr double kReliabilityEdges[] = {0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0};

struct Reliability {
  struct Bin {
    double mean = 0;  ///< mean forecast probability
    Rate right;
  };
  struct Sets {
    Rate coverage;         ///< how often the 95 % set contains the truth
    double mean_size = 0;  ///< mean number of explanations in the set
  };
  std::vector<Bin> bins;  ///< between kReliabilityEdges, of all explanations of all cases
  /// Expected calibration error of the first explanation (Naeini et al., AAAI 2015): mean difference between
  /// probability and hit rate of the bins, weighted by their counts. The 95 % interval is computed by
  /// bootstrap over the cases. With few cases, the error is biased upwards.
  double error = 0, error_low = 0, error_high = 0;
  int cases = 0;
  std::vector<std::pair<std::string, Sets>> sets;  ///< by group; only cases with one hidden listed effect
};
Reliability reliability(const std::vector<Forecast>& forecasts);
/// Returns text diagram, calibration error and sets as Markdown; empty without forecasts.
std::string reliability_markdown(const Reliability& r);
nlohmann::json reliability_json(const Reliability& r);

}  // namespace swingbank::research::blind::score
