#pragma once
// Voltage behind X'' and current of a machine on axes that rotate with its rotor. The initial angle between
// rotor and terminal remains unknown, because no terminal signal shows it.
#include <Eigen/Core>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// Complex time series over one smooth segment. With `angle` the rotor's initial angle,
/// \f$ \psi_d + j\psi_q = flux\, e^{-j\,angle} \f$ and \f$ i_q - j i_d = current\, e^{-j\,angle} \f$.
struct Turning {
  Eigen::VectorXcd flux, current;
  Eigen::VectorXd V, speed, P, Ifd;  ///< time series over the segment; P is the air-gap power [pu]
  Eigen::VectorXd relative;          ///< rotor angle relative to the terminal, minus the initial value [rad]
  std::complex<double> flux0, current0;  ///< values at the record's first sample, in the terminal's frame
  double Ifd0 = 0, P0 = 0;               ///< values at the record's first sample [pu]
  double field_before = 0;               ///< integral of Ifd0 - Ifd up to the segment's start [pu s]
  double step = 0;
};

/// Computes the time series. Ra + jX [pu]: impedance between the terminal and the voltage behind X''.
/// `first`, `count`: first sample and largest number of samples of the segment.
Turning turning(const Recording& r, double Ra, double X, std::size_t first, std::size_t count);

}  // namespace swingbank::sim::direct
