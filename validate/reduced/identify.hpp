#pragma once
// Identification of a trial (candidate change of a plant) from many starts at once, with the plant's
// parameters eliminated in closed form (reduced_cost.hpp). A control block is simulated in open loop and
// compared with the inferred input (reduce.hpp). Any other change is simulated with the whole plant
// (closed_loop.hpp).
#include <cstdint>
#include <vector>

#include "validate/reduced/reduce.hpp"

namespace swingbank::validate::reduced {

/// A candidate change: the plant with the changed or added block at its prior mean, and the free parameters
/// of the block.
struct Trial {
  sim::plant::Plant plant;                       ///< plant with the block
  std::vector<fit::FreeParameter> free;          ///< free parameters of the block, with their priors
  std::uint64_t stream = 0;                      ///< stream of the random draws (fit::Draws)
  double length = 0;                             ///< length of the records [s], for the draws; 0: unknown
  std::vector<std::vector<double>> starts = {};  ///< start values of `free`, which compete with the draws
};

/// A local minimum of the cost.
struct Optimum {
  std::vector<double> values;  ///< values of the trial's free parameters
  Eigen::VectorXd plant;       ///< changes of the plant's parameters, in z (fit/axis.hpp)
  Eigen::VectorXd series;      ///< response of the trial (ReducedCost::responses)
  double cost = 0;             ///< chi2 of the records and of the priors of plant and block
  int starts = 0;              ///< number of starts that ended within 1 of this cost
};

/// Effort of an identification.
struct IdentifyOptions {
  int draws = 16;  ///< number of draws per free parameter and round
  int kept = 6;    ///< number of best draws that are optimised
  /// Steps of each start; the better half then takes twice as many, and so on (successive halving).
  int steps = 5;
  std::vector<Eigen::Index> freed = {};  ///< changes (add_changes) that are estimated together with the block
};

/// Returns the distinct local minima in ascending order of cost; empty if no draw acts. `known`: further
/// start values of the trial's free parameters. `options.freed` is ignored, because `reduced` defines the
/// free changes.
std::vector<Optimum> identify(const ReducedCost& reduced, const Trial& trial,
                              const IdentifyOptions& options = {},
                              const std::vector<std::vector<double>>& known = {});
/// Identifies a block in open loop (ReducedPlant).
std::vector<Optimum> identify(const Reduction& reduction, event::InputKind input, const Trial& trial,
                              const IdentifyOptions& options = {},
                              const std::vector<std::vector<double>>& known = {});

}  // namespace swingbank::validate::reduced
