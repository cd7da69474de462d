#pragma once
// Closed-form estimate of a round-rotor machine's parameters (GENROU's equations) from one smooth segment of
// its record. The method is a chain of small linear least-squares problems. It needs searches over one
// variable only, and neither start values nor training.
#include <vector>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// Parameters in GENROU's notation. X''d and Ra are given; all others are estimated.
struct RoundRotor {
  double Tdop = 0, Tdopp = 0, Tqop = 0, Tqopp = 0, H = 0, D = 0, Xd = 0, Xq = 0, Xdp = 0, Xqp = 0;
  ///< time constants and H [s]; D and reactances [pu]
  double Xdpp = 0, Xl = 0, S10 = 0, S12 = 0;  ///< [pu]
  double angle = 0;  ///< rotor angle relative to the terminal at the first sample [rad]
  double rms_error =
      0;  ///< sum of the logarithms of the chain's residuals; compares candidates of one record
};

/// Returns the candidates, best first. There may be several, because the d axis alone may fit at several
/// angles. The segment starts after the last voltage step. Empty if the record has no field current, or the
/// segment has fewer than 40 samples. Derivation: docs/explanation/closed-form.md.
std::vector<RoundRotor> round_rotor(const Recording& record, double Ra, double Xdpp);

}  // namespace swingbank::sim::direct
