#pragma once
// Newton power flow on the full network, in polar form, with sparse matrices.
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// Result of a switched shunt that was stepped or whose regulated voltage is outside its band.
struct SteppedShunt {
  std::size_t which;    ///< index into Network::switched
  double susceptance;   ///< [pu]
  bool in_band = true;  ///< whether the regulated voltage reached its band
};
/// Solution of the power flow.
struct PowerFlow {
  std::vector<Complex> voltage;     ///< per bus [pu]
  std::vector<Complex> generation;  ///< power of each generator [pu on base_mva]
  int iterations = 0;               ///< number of Newton iterations
  double mismatch = 0.0;            ///< largest power mismatch [pu]
  /// Buses whose generators are at a reactive limit and do not regulate their voltage.
  std::vector<int> at_limit = {};
  std::vector<SteppedShunt> stepped = {};  ///< switched shunts that were stepped or missed their band
};
/// Options of the power flow.
struct PowerFlowOptions {
  double tolerance = 1e-12;     ///< largest accepted mismatch [pu]
  int limit = 30;               ///< largest number of Newton iterations per start, times 5 with short steps
  bool reactive_limits = true;  ///< apply the generators' reactive limits
  bool step_shunts = false;     ///< step switched shunts until the regulated voltages lie in their bands
};
/// Solves the power flow.
/// - A generator regulates the voltage of its own bus, or of the bus Generator::regulated.
/// - Generators that regulate one remote bus share their reactive power by Generator::share.
/// - A bus whose reactive power would be outside q_min to q_max delivers the limit. It regulates again once
///   the voltage has crossed the set-point, at most three times. Slack buses and buses with q_min above q_max
///   have no limits.
/// - In every island at least one slack bus sets the angle and balances the power.
/// - Between solutions, every switched shunt whose regulated voltage is outside its band moves by one step. A
/// shunt that would reverse
///   its direction stops.
/// - A bus of type 2 without a generator in service is a load bus.
/// - At a bus of type 1, generators deliver their P and Q of the file.
/// - If Newton's method fails from the file's voltages, it is repeated from a flat start, then from both with
///   short steps.
/// - Mismatches below the rounding of the powers at a bus count as zero.
/// Throws InputError on divergence (with the bus of the largest mismatch), and for an island without a slack
/// bus.
PowerFlow solve_power_flow(const Network& network, const PowerFlowOptions& options = {});

/// Returns the file's own voltages as the solution; of buses joined by ties, only one keeps its voltage.
/// Generators deliver the power that balances their buses. At every other bus a constant admittance is added
/// to the network for balance, with a remark.
PowerFlow flow_of_file(Network& network);

/// Returns the power imbalance of the file's voltages at each bus [pu]: power into branches and shunts, plus
/// loads, less P and Q of the generators in service.
std::vector<Complex> imbalance_of_file(const Network& network);

}  // namespace swingbank::sim::network
