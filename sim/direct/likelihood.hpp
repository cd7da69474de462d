#pragma once
// Maximum a posteriori estimates of a machine's parameters from a record with known noise level, and their
// Cramer-Rao bound. Terminal voltage and angle are played in. P, Q, speed and field current are compared with
// the complete machine model (detail/innovations). The comparison begins with the steady state before the
// event.
#include <span>
#include <vector>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// Prior of a parameter: bounds, and mean and standard deviation of a normal distribution.
struct ParameterPrior {
  int index = 0;  ///< index in the effect's parameters
  double low = 0, high = 0, mean = 0, deviation = 0;
  ///< bounds; mean and standard deviation [unit of the parameter]
};
/// Returns a prior with mean and variance of the uniform distribution between the bounds.
ParameterPrior uniform_prior(int index, double low, double high);

/// Maximum a posteriori estimate of the parameters.
struct MostProbable {
  std::vector<double> p;  ///< all parameters of the effect
  double chi_square = 0;  ///< chi2 per degree of freedom, steady state and prior included; 1 expected
  double cost = 0;        ///< -2 times the logarithm of the posterior, up to a constant
  int iterations = 0;     ///< number of steps
};
/// Effort of the maximum a posteriori estimate.
struct LikelihoodOptions {
  int iterations = 60;    ///< largest number of steps
  double longest = 13.0;  ///< maximum length of the compared record after the event [s]
};

/// Whether the likelihood supports the machine: at most kMostFlowing states, at most 20 parameters, and a
/// voltage behind a constant impedance.
bool has_likelihood(const Effect& machine);

/// Returns the estimate from one start. The record must state its noise level and should state the event's
/// start. With fewer than kShortestStretch samples after the event, it returns the start.
MostProbable most_probable(const Effect& machine, const Recording& record, std::vector<double> start,
                           std::span<const ParameterPrior> free, const LikelihoodOptions& options = {});
/// Returns the best estimate from several starts. It tries the candidates, then the prior's mean, then at
/// most twelve random draws, until two starts agree in cost.
MostProbable most_probable_of(const Effect& machine, const Recording& record,
                              std::span<const std::vector<double>> candidates,
                              std::span<const ParameterPrior> free, const LikelihoodOptions& options = {});
/// Returns the estimate of one search from a start near the truth, such as a neural network's estimate. If
/// its reduced chi-square is more than noise explains, returns the best estimate from several starts.
MostProbable most_probable_near(const Effect& machine, const Recording& record,
                                const std::vector<double>& start, std::span<const ParameterPrior> free,
                                const LikelihoodOptions& options = {});

/// Returns the variances of the free parameters by the Bayesian Cramer-Rao bound at the true parameters. The
/// record is free of noise; its `noise` is the level for which the bound holds. The bound treats the
/// operating point and the parameters of `free` as unknown.
std::vector<double> error_bound(const Effect& machine, const Recording& record,
                                const std::vector<double>& truth, std::span<const ParameterPrior> free,
                                const LikelihoodOptions& options = {});

}  // namespace swingbank::sim::direct
