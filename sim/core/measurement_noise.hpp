#pragma once
// White measurement noise of a machine's record, set by one level L (0.001: 0.1 %).
//   P, Q, V [pu of the machine], theta [rad]   L
//   Ifd, Efd                                   L times the value (relative errors of shunts, transducers)
//   speed [pu]                                 L/20, because a toothed wheel measures it; 3 mHz at L = 0.1 %
// Phasor instruments are rated by total vector error. An error vector of relative length L changes the
// magnitude by at most L and the angle by at most L rad. IEEE C37.118.1 allows 1 %; good instruments have
// 0.1 to 0.5 %.
// Frequency is the filtered derivative of the angle, so its noise is that of theta after the same filter.
#include <cmath>

namespace swingbank::sim {

/// Standard deviations of one sample.
struct MeasurementNoise {
  double level = 0;                                                ///< L; 0: no noise
  static constexpr double kOfSpeed = 0.05;                         ///< speed's level as a fraction of L
  [[nodiscard]] double phasor() const { return level; }            ///< of P, Q, V [pu] and theta [rad]
  [[nodiscard]] double speed() const { return kOfSpeed * level; }  ///< of the speed [pu]
  [[nodiscard]] double field(double value) const { return level * std::abs(value); }  ///< of Ifd or Efd [pu]
};

}  // namespace swingbank::sim
