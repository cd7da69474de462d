#pragma once
// Reference integrator: SUNDIALS IDA with KLU on the unreduced differential-algebraic equations (all bus
// voltages are unknowns). Slow and exact; the fast integrator is tested against it.
#include "base/constants.hpp"
#include "sim/core/trajectory.hpp"
#include "sim/grid/grid.hpp"
#include "sim/network/event.hpp"

namespace swingbank::sim::reference {

/// Options of a reference simulation.
struct ReferenceOptions {
  double t_end = 15.0, rate = 120.0;  ///< end of the simulation [s]; samples per second [1/s]
  double rtol = 1e-8, atol = 1e-10;   ///< error per step of each unknown
  std::vector<int> plants;            ///< empty: all
  std::vector<Channel> channels;      ///< empty: all of kChannels
  std::vector<int> buses;             ///< buses with recorded voltage, by index in the network
  bool after_switching = false;       ///< at a switching time record the value just after it
  /// Two criteria end a run, both within each present island of the grid. First: largest change of a rotor
  /// angle difference since the start [rad].
  double lose_at = constants::pi;
  double lose_at_slip = 0.1;  ///< second: largest speed difference of two rotors [pu]
};

/// After a loss of synchronism, or any other end before t_end, the remaining samples repeat the last value.
struct ReferenceRun : Trajectory {
  std::vector<int> buses;     ///< by index in the network
  std::vector<double> bus_v;  ///< [bus][sample], magnitude [pu]
  std::vector<double>
      bus_theta;        ///< [bus][sample], angle, continuous from sample to sample; held while V = 0 [rad]
  long steps = 0;       ///< integrator steps
  std::string lost_by;  ///< criterion that ended the run and the two plants: "angle: 30 against 39"
};

/// Simulates an event. Throws InputError if the event does not apply to this network (unknown bus; an island
/// without machine and fault) or an operating point is infeasible.
ReferenceRun run_reference(const grid::Grid& grid, const network::Event& event,
                           const ReferenceOptions& options);

}  // namespace swingbank::sim::reference
