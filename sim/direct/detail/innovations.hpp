#pragma once
// Innovations of a Kalman filter on a noisy record. The noise of the played-in voltage acts immediately
// through the stator equations, and later through the rotor states. The innovations contain both effects and
// are white at the true parameters. Up to a constant, the log-likelihood is therefore
// -(r^T r + ln det S) / 2, with the whitened innovations r and the covariance S of the innovations.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim/direct/detail/played.hpp"

namespace swingbank::sim::direct {

using OutputVector = Eigen::Matrix<double, kOutputs, 1>;

/// Filter gain of one sample.
struct Gain {
  Eigen::Matrix<double, kMostFlowing, kOutputs> onto_states;  ///< gain onto the next sample's states
  Eigen::Matrix<double, kOutputs, kOutputs> whitening;        ///< inverse Cholesky factor of cov(innovation)
};
/// Result of the filter for given parameters and operating point.
struct Filtered {
  std::vector<Gain> gains;
  std::vector<OutputVector> white;  ///< whitened innovations
  double log_determinant = 0;       ///< ln det of the covariance of all innovations
  /// The record without its most probable noise. Sensitivities are computed with its voltage. With the noisy
  /// voltage they would be correlated with the innovations, and the fit would be biased.
  NoisyRecord likely;
};
Filtered filter(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
                const std::array<double, kSteady>& steady);

/// Largest number of unknowns of linearise().
constexpr Eigen::Index kMostUnknowns = 24;

/// A parameter in units of its `scale`.
struct ScaledParameter {
  int index = 0;  ///< index in the effect's parameters
  double scale = 1;
};
/// Residuals at the parameters and the operating point of a filter, with its gains and voltage: the steady
/// residuals, then the whitened innovations. Unknowns: the parameters, then the operating point.
struct LinearisedResiduals {
  Eigen::VectorXd value;
  /// Derivatives of the residuals. The unknowns are the first columns, and the others have no meaning.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> columns;
  Eigen::Index unknowns = 0;
  /// Response of the machine to the voltage without noise: outputs of each sample.
  std::vector<std::array<double, kOutputs>> response;

  /// Returns the derivatives: residuals x unknowns.
  [[nodiscard]] auto jacobian() const { return columns.leftCols(unknowns); }
};
LinearisedResiduals linearise(const Effect& machine, const NoisyRecord& record, const Filtered& filtered,
                              const std::vector<double>& p, const std::array<double, kSteady>& steady,
                              std::span<const ScaledParameter> parameters);

/// Returns the residuals at other parameters and another operating point, with the same gains and voltage.
/// `response`: LinearisedResiduals::response.
Eigen::VectorXd residuals(const Effect& machine, const NoisyRecord& record, const Filtered& filtered,
                          const std::vector<std::array<double, kOutputs>>& response,
                          const std::vector<double>& p, const std::array<double, kSteady>& steady);

/// Returns the number of residuals: one for each mean before the event (P, Q, V, theta and, if recorded,
/// Ifd), then one for each compared signal of every sample.
std::size_t residual_count(const NoisyRecord& record);

}  // namespace swingbank::sim::direct
