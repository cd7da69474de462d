#pragma once
// A machine's parameters from a record with noise of known level: the most probable ones, and how close
// anybody can come. Terminal voltage and angle are played in; P, Q, speed and field current are compared with
// the whole machine, from the steady state before the event to the record's end (detail/innovations).
#include <span>
#include <vector>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// What is known of a parameter beforehand: its bounds, and mean and standard deviation of a Gaussian prior.
struct FreeParameter {
  int index = 0;  ///< among the effect's parameters
  double low = 0, high = 0, mean = 0, deviation = 0;
};
/// The prior has mean and variance of the uniform distribution between the bounds.
FreeParameter uniform_parameter(int index, double low, double high);

struct MostProbable {
  std::vector<double> p;  ///< of every parameter of the effect
  double chi_square = 0;  ///< of the innovations, per degree of freedom: about 1 where the model is right
  double cost = 0;        ///< sum of squares of innovations and prior
  int iterations = 0;
};
struct LikelihoodOptions {
  int rounds = 20;        ///< of linearisations
  int iterations = 8;     ///< of each round
  double longest = 13.0;  ///< stretch behind the event [s]
};

/// Whether the machine has no more states than this room's duals hold, and lies behind a constant impedance.
bool has_likelihood(const Effect& machine);

/// From one start. The record says its noise and should say when the event begins. A stretch of less than
/// kShortestStretch samples behind it says nothing: the start comes back.
MostProbable most_probable(const Effect& machine, const Recording& record, std::vector<double> start,
                           std::span<const FreeParameter> free, const LikelihoodOptions& options = {});
/// The best from several: the candidates, the prior's mean, then draws, until chi-square says that one is
/// right.
MostProbable most_probable_of(const Effect& machine, const Recording& record,
                              std::span<const std::vector<double>> candidates,
                              std::span<const FreeParameter> free, const LikelihoodOptions& options = {});

/// Bayesian Cramer-Rao bound at the true parameters: variances of the free ones. The record has no noise yet
/// and says which it is going to have. Operating point and what `free` names are unknown.
std::vector<double> error_bound(const Effect& machine, const Recording& record,
                                const std::vector<double>& truth, std::span<const FreeParameter> free,
                                const LikelihoodOptions& options = {});

}  // namespace swingbank::sim::direct
