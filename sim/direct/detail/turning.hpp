#pragma once
// Voltage behind X'' and current of a machine on axes that turn with its rotor, up to the one angle between
// rotor and terminal at the start, which no terminal signal shows.
#include <Eigen/Core>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// Complex columns over one smooth stretch. With `angle` the rotor's at the start,
///   psi_d + j psi_q = flux exp(-j angle),   i_q - j i_d = current exp(-j angle).
struct Turning {
  Eigen::VectorXcd flux, current;
  Eigen::VectorXd V, speed, P, Ifd;      ///< of the stretch; P is the air-gap power [pu]
  Eigen::VectorXd relative;              ///< rotor against terminal, less the value at the start [rad]
  std::complex<double> flux0, current0;  ///< at the first sample, in the terminal's frame
  double Ifd0 = 0, P0 = 0;               ///< at the first sample
  double field_before = 0;  ///< integral of Ifd0 - Ifd from the first sample to the stretch's [pu s]
  double step = 0;
};

/// Ra + jX'' [pu]: what lies between the terminal and the flux. `count`: samples at most.
Turning turning(const Recording& r, double Ra, double X, std::size_t first, std::size_t count);

}  // namespace swingbank::sim::direct
