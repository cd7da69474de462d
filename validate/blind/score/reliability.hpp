#pragma once
// Are the probabilities true? Of all explanations that were given 80 %, four in five should be the right one.
#include <cstddef>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "base/rate.hpp"

namespace swingbank::validate::blind::score {

/// What a verdict said of one case.
struct Forecast {
  std::string group;                  ///< "P, Q only"; forecasts of a group are told together as well
  std::vector<double> probabilities;  ///< of each explanation, the most probable first
  std::vector<char> right;            ///< likewise: whether it is the truth
  bool listed = false;                ///< the truth is one effect of the list
};

/// Edges of the bins of the diagram.
inline constexpr double kReliabilityEdges[] = {0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0};

struct Reliability {
  struct Bin {
    double mean = 0;  ///< probability that was said
    Rate right;
  };
  struct Sets {
    Rate holds;            ///< the truth is in the set that makes up 95 %
    double mean_size = 0;  ///< of the set
  };
  std::vector<Bin> bins;  ///< between kReliabilityEdges, of all explanations of all cases
  /// Mean difference of what was said of the first explanation and how often it was right, in bins, weighed
  /// by their counts (expected calibration error; Naeini et al., AAAI 2015), with its 95 % interval from
  /// resampled cases. Scatter of few cases makes it larger than it is, never smaller.
  double error = 0, error_low = 0, error_high = 0;
  int cases = 0;
  std::vector<std::pair<std::string, Sets>>
      sets;  ///< by group, of cases in which one listed effect is hidden
};
Reliability reliability(const std::vector<Forecast>& forecasts);
/// A diagram in text, the calibration error and the sets. Nothing without forecasts.
std::string reliability_markdown(const Reliability& r);
nlohmann::json reliability_json(const Reliability& r);

}  // namespace swingbank::validate::blind::score
