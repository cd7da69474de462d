#pragma once
// Reference integrator: SUNDIALS IDA with KLU on the unreduced differential-algebraic equations (all bus
// voltages are unknowns). It is slow and accurate; the fast integrator is tested against it.
#include "base/constants.hpp"
#include "sim/core/trajectory.hpp"
#include "sim/grid/grid.hpp"
#include "sim/network/event.hpp"

namespace swingbank::sim::reference {

/// Options of a reference simulation.
struct ReferenceOptions {
  double t_end = 15.0, rate = 120.0;  ///< end of the simulation [s]; samples per second [1/s]
  double rtol = 1e-8, atol = 1e-10;   ///< relative and absolute tolerance of each unknown's error in a step
  std::vector<int> plants;            ///< recorded plants; empty: all
  std::vector<Channel> channels;      ///< recorded channels; empty: all of kChannels
  std::vector<int> buses;             ///< buses with recorded voltage, by index in the network
  bool after_switching = false;       ///< true: a sample at a switching time is the value after it
  /// A run ends if the angle difference of two rotors in an island has changed by this value since the start
  /// [rad], or if their speed difference exceeds `lose_at_slip`.
  double lose_at = constants::pi;
  double lose_at_slip = 0.1;  ///< largest speed difference of two rotors in an island [pu]
};

/// Result of a reference simulation. After a loss of synchronism, or any other end before t_end, the
/// remaining samples repeat the last value.
struct ReferenceRun : Trajectory {
  std::vector<int> buses;         ///< recorded buses, by index in the network
  std::vector<double> bus_v;      ///< [bus][sample], voltage magnitude [pu]
  std::vector<double> bus_theta;  ///< [bus][sample], unwrapped voltage angle [rad]; constant while V = 0
  long steps = 0;                 ///< integrator steps
  std::string lost_by;            ///< criterion that ended the run and the two plants: "angle: 30 against 39"
};

/// Simulates an event. Throws InputError if the event does not apply to this network (unknown bus; an island
/// with converters but neither machine nor fault), if an operating point is infeasible, or if the network
/// equations have no voltage solution after a switching.
ReferenceRun run_reference(const grid::Grid& grid, const network::Event& event,
                           const ReferenceOptions& options);

}  // namespace swingbank::sim::reference
