#pragma once
// Identification of single blocks against the inferred input: each is simulated open loop, from many starts
// at once, and the plant's parameters are eliminated in closed form (reduce.hpp), so that no trial simulates
// the plant.
#include <cstdint>
#include <vector>

#include "validate/reduced/reduce.hpp"

namespace swingbank::validate::reduced {

/// A candidate: the plant with the block at its prior mean, and the block's free parameters.
struct Trial {
  sim::plant::Plant plant;
  std::vector<fit::FreeParameter> free;
  std::uint64_t stream = 0;  ///< of the random draws, which depend on nothing else
  /// Further draws, that suit the block: a limiter's pickups in their order, its times within the record's.
  std::vector<std::vector<double>> draws = {};
};

/// A local minimum.
struct Optimum {
  std::vector<double> values;  ///< of the trial's free parameters
  Eigen::VectorXd plant;       ///< changes of the plant's parameters, on the inference's axes
  Eigen::VectorXd series;      ///< that the block adds to the plant's own controls, at all knots [pu]
  double cost = 0;             ///< chi2 of the records and of the priors of plant and block
  int starts = 0;              ///< how many ended within 1 of this cost
};

struct IdentifyOptions {
  int draws = 96;  ///< evaluated
  int kept = 6;    ///< the best of them, which are optimised
  int steps = 5;   ///< of each; then the better half takes twice as many, and so on (successive halving)
  std::vector<Eigen::Index> freed = {};  ///< changes (add_changes) that are made beside the block
};

/// Distinct local minima, best first; none where no draw can be simulated. `known`: further starting values
/// of the trial's free parameters.
std::vector<Optimum> identify(const Reduction& reduction, event::InputKind input, const Trial& trial,
                              const IdentifyOptions& options = {},
                              const std::vector<std::vector<double>>& known = {});

}  // namespace swingbank::validate::reduced
