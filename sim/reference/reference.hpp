#pragma once
// The reference integrator: SUNDIALS IDA with KLU on the unreduced differential-algebraic equations (all bus
// voltages are unknowns). Slow and exact: the fast kernel is tested against it.
#include "base/constants.hpp"
#include "sim/core/trajectory.hpp"
#include "sim/grid/grid.hpp"
#include "sim/network/event.hpp"

namespace swingbank::sim::reference {

struct ReferenceOptions {
  double t_end = 15.0, rate = 120.0;
  double rtol = 1e-8, atol = 1e-10;  ///< error per step of every single unknown
  std::vector<int> plants;           ///< empty: all
  std::vector<Channel> channels;     ///< empty: all of kChannels
  std::vector<int> buses;            ///< whose voltage is recorded as well, by index in the network
  bool after_switching = false;      ///< at a switching instant give the value just after it
  /// Two criteria end a run, both judged within each island of the grid as it then is: a rotor angle has
  /// moved by so much against another's since the start [rad],
  double lose_at = constants::pi;
  double lose_at_slip = 0.1;  ///< or a rotor is this much faster or slower than another [pu]
};

/// After a loss of synchronism (or any other end before t_end) the remaining samples repeat the last value.
struct ReferenceRun : Trajectory {
  std::vector<int> buses;     ///< by index in the network
  std::vector<double> bus_v;  ///< [bus][sample], magnitude [pu]
  std::vector<double>
      bus_theta;        ///< [bus][sample], angle, continuous from sample to sample; held while V = 0 [rad]
  long steps = 0;       ///< integrator steps
  std::string lost_by;  ///< which criterion ended the run, and the two plants: "angle: 30 against 39"
};

/// Throws InputError where the event cannot be played on this network (unknown bus, a part of the grid cut
/// off with no machine and no fault in it) or an operating point cannot be held.
ReferenceRun run_reference(const grid::Grid& grid, const network::Event& event,
                           const ReferenceOptions& options);

}  // namespace swingbank::sim::reference
