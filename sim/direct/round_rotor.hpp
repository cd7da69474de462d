#pragma once
// The parameters of a round-rotor machine (GENROU's equations) from one smooth stretch of its record, by a
// chain of small linear least squares: no search but over one angle, no start values, no learning.
#include <vector>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// In GENROU's terms. X''d is given, as is Ra; all else is found.
struct RoundRotor {
  double Tdop = 0, Tdopp = 0, Tqop = 0, Tqopp = 0, H = 0, D = 0, Xd = 0, Xq = 0, Xdp = 0, Xqp = 0;
  double Xdpp = 0, Xl = 0, S10 = 0, S12 = 0;
  double angle = 0;   ///< rotor against terminal at the first sample [rad]
  double misfit = 0;  ///< sum of the logarithms of the chain's residuals: smaller is better, of one record
};

/// The candidates, best first: the d axis alone may fit at several angles. The stretch begins behind the last
/// leap of the voltage. Empty where the record has no field current, or the stretch has fewer than forty
/// samples. Derivation: docs/closed-form.md.
std::vector<RoundRotor> round_rotor(const Recording& record, double Ra, double Xdpp);

}  // namespace swingbank::sim::direct
