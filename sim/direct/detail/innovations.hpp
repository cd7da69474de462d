#pragma once
// Innovations of a Kalman filter on a noisy record. The noise of the played-in voltage acts immediately
// through the stator equations, and later through the rotor states. The innovations contain both effects and
// are white at the true parameters. Minus half the sum of their squares is therefore the log-likelihood, up
// to a constant.
#include <Eigen/Core>
#include <vector>

#include "sim/core/scalar.hpp"
#include "sim/direct/detail/noisy_record.hpp"
#include "sim/direct/detail/playback_machine.hpp"

namespace swingbank::sim::direct {

/// Operating point before the event. It is estimated, because means of noisy samples are inexact.
enum Steady { kP0, kQ0, kV0, kTheta0, kSteady };

/// Filter gain of one sample.
struct Gain {
  using State = Eigen::Matrix<double, kMostFlowing, 1>;
  Eigen::Matrix<double, kMostFlowing, kOutputs> onto_states;  ///< gain onto the next sample's states
  Eigen::Matrix<double, kOutputs, kOutputs> whitening;        ///< inverse Cholesky factor of cov(innovation)
};
/// Result of the filter for given parameters and operating point.
struct Filtered {
  std::vector<Gain> gains;
  std::vector<Eigen::Matrix<double, kOutputs, 1>> white;  ///< whitened innovations
  /// The record without its most probable noise, and the machine's response to it. Sensitivities are computed
  /// with this record. With the noisy voltage they would be correlated with the innovations, and the fit
  /// would be biased.
  NoisyRecord likely;
};
Filtered filter(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
                const std::array<double, kSteady>& steady);

/// Returns the number of outputs of innovations(): one for each mean before the event, then one for each
/// compared signal of every sample.
std::size_t innovation_count(const NoisyRecord& record);
/// Computes innovation_count() whitened innovations `out`, of unit variance at the true p. T: double or D8.
template <class T>
void innovations(const Effect& machine, const NoisyRecord& record, const std::vector<Gain>& gains,
                 const std::vector<T>& p, const std::array<T, kSteady>& steady, T* out);

}  // namespace swingbank::sim::direct
