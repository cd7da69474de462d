#pragma once
// Newton power flow on the full network, in polar form, sparse.
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// What became of a switched shunt that was stepped.
struct SteppedShunt {
  std::size_t which;    ///< index into Network::switched
  double susceptance;   ///< [pu]
  bool in_band = true;  ///< whether the voltage it holds came into its band
};
struct PowerFlow {
  std::vector<Complex> voltage;  ///< per bus [pu]
  std::vector<Complex>
      generation;  ///< per generator [pu on base_mva]; Q (and slack P) shared by MVA at a bus
  int iterations = 0;
  double mismatch = 0.0;  ///< largest power mismatch [pu]
  /// Buses whose generators stand at a reactive limit, so that they do not hold their voltage.
  std::vector<int> at_limit = {};
  std::vector<SteppedShunt> stepped = {};
};
struct PowerFlowOptions {
  double tolerance = 1e-12;  ///< [pu]
  int limit = 30;            ///< Newton iterations
  bool reactive_limits = true;
  bool step_shunts = false;  ///< switched shunts take steps until the voltages they hold lie in their bands
};
/// A generator holds the voltage of its bus, or of `regulated`; several that hold one bus from others share
/// their reactive power by `share`. Where that would need more than q_min to q_max the bus delivers the
/// limit, and it returns to holding once the voltage lets it; a slack bus has no limits, and neither has one
/// whose q_min is above q_max. In every island at least one slack bus sets the angle and balances the power.
/// Switched shunts that step do so one step at a time, all at once, and one that comes back and forth stays.
/// A bus of type 2 without a generator in service is a load bus, and at a bus of type 1 generators deliver
/// their P and Q. If Newton's method fails from the file's voltages it is tried once more from a flat start.
/// Mismatches below the rounding of the powers that meet at a bus count as zero. Throws InputError on
/// divergence (naming the bus with the largest mismatch), and for an island without a slack bus.
PowerFlow solve_power_flow(const Network& network, const PowerFlowOptions& options = {});

/// The file's own voltages as the solution: generators deliver what balances their buses, at every other bus
/// a constant admittance is added to the network that does, with a remark.
PowerFlow flow_of_file(Network& network);

/// Per bus, what the file's voltages leave over: power into branches and shunts, plus loads, less the P and Q
/// of the generators in service [pu].
std::vector<Complex> imbalance_of_file(const Network& network);

}  // namespace swingbank::sim::network
