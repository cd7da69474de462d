#pragma once
// How much white noise instruments put on a machine's record, by one level L (0.001: 0.1 %).
//   P, Q, V [pu of the machine], theta [rad]   L: a phasor instrument is judged by its total vector error,
//   and
//                                              an error of L across the phasor is L in magnitude and L rad in
//                                              angle (IEEE C37.118.1 allows 1 %; good ones have 0.1 % to 0.5
//                                              %)
//   Ifd, Efd                                   L of the value: shunts and transducers err by a share of it
//   speed [pu]                                 L/20: a toothed wheel is timed, not sampled; 3 mHz at 0.1 %
// Frequency is the angle behind a filter, so its noise is theta's behind the same filter.
#include <cmath>

namespace swingbank::sim {

/// Standard deviations of one sample.
struct MeasurementNoise {
  double level = 0;  ///< L; 0: none
  static constexpr double kOfSpeed = 0.05;
  [[nodiscard]] double phasor() const { return level; }                               ///< [pu, rad]
  [[nodiscard]] double speed() const { return kOfSpeed * level; }                     ///< [pu]
  [[nodiscard]] double field(double value) const { return level * std::abs(value); }  ///< [pu]
};

}  // namespace swingbank::sim
