#pragma once
// What a Kalman filter finds new in each sample of a noisy record. The noise of the played-in voltage acts at
// once, through the stator's algebra, and later, through the rotor that it drives; innovations hold both, and
// with the right parameters they are white. So their squares are the likelihood.
#include <Eigen/Core>
#include <vector>

#include "sim/core/scalar.hpp"
#include "sim/direct/detail/driven_machine.hpp"
#include "sim/direct/detail/noisy_record.hpp"

namespace swingbank::sim::direct {

/// The operating point before the event, which means over noisy samples do not tell exactly.
enum Steady { kP0, kQ0, kV0, kTheta0, kSteady };

/// Of one sample.
struct Gain {
  using State = Eigen::Matrix<double, kMostFlowing, 1>;
  Eigen::Matrix<double, kMostFlowing, kOutputs> onto_states;  ///< of the step to the next sample
  Eigen::Matrix<double, kOutputs, kOutputs> whitening;        ///< inverse Cholesky factor of the covariance
};
/// What the filter makes of a record with these parameters and this operating point.
struct Filtered {
  std::vector<Gain> gains;
  std::vector<Eigen::Matrix<double, kOutputs, 1>> white;  ///< innovations, whitened
  /// The record without the noise that it most probably has, and with what the machine then shows. Slopes are
  /// taken here: those at the noisy voltage hold noise that is in the innovations as well, and a fit would
  /// make both small together.
  NoisyRecord likely;
};
Filtered filter(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
                const std::array<double, kSteady>& steady);

/// How many numbers innovations() gives: whitened, of every sample, then those of the means before the event.
std::size_t innovation_count(const NoisyRecord& record);
/// T: double or D8. out: innovation_count() numbers of unit variance where p is right.
template <class T>
void innovations(const Effect& machine, const NoisyRecord& record, const std::vector<Gain>& gains,
                 const std::vector<T>& p, const std::array<T, kSteady>& steady, T* out);

}  // namespace swingbank::sim::direct
