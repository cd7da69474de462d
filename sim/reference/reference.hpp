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
  double lose_at = constants::pi;    ///< pairwise rotor angle difference that ends a run [rad]
};

/// After a loss of synchronism (or any other end before t_end) the remaining samples repeat the last value.
struct ReferenceRun : Trajectory {
  std::vector<int> buses;     ///< by index in the network
  std::vector<double> bus_v;  ///< [bus][sample], magnitude [pu]
  std::vector<double>
      bus_theta;   ///< [bus][sample], angle, continuous from sample to sample; held while V = 0 [rad]
  long steps = 0;  ///< integrator steps
};

/// Throws InputError where the event cannot be played on this network (unknown bus, a part of the grid cut
/// off with no machine and no fault in it) or an operating point cannot be held.
ReferenceRun run_reference(const grid::Grid& grid, const network::Event& event,
                           const ReferenceOptions& options);

}  // namespace swingbank::sim::reference
