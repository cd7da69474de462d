#pragma once
// Newton power flow on the full network, in polar form, sparse.
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::network {

struct PowerFlow {
  std::vector<Complex> voltage;  ///< per bus [pu]
  std::vector<Complex>
      generation;  ///< per generator [pu on base_mva]; Q (and slack P) shared by MVA at a bus
  int iterations = 0;
  double mismatch = 0.0;  ///< largest power mismatch [pu]
};
/// A bus of type 2 without a generator in service is a load bus; reactive limits are not enforced. If
/// Newton's method fails from the file's voltages it is tried once more from a flat start. Mismatches below
/// the rounding of the powers that meet at a bus count as zero. Solves to `tolerance` [pu]. Throws InputError
/// on divergence (naming the bus with the largest mismatch), an islanded bus, a missing or second slack bus.
PowerFlow solve_power_flow(const Network& network, double tolerance = 1e-12, int limit = 30);

}  // namespace swingbank::sim::network
