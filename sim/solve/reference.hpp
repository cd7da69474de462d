#pragma once
// The reference integrator: SUNDIALS IDA with KLU on the unreduced differential-algebraic equations (all bus
// voltages are unknowns). Slow and exact: the fast kernel is tested against it.
#include "sim/network/event.hpp"
#include "sim/solve/grid.hpp"
#include "sim/solve/trajectory.hpp"

namespace swingbank::sim {

struct ReferenceOptions {
  double t_end = 15.0, rate = 120.0;
  double rtol = 1e-8, atol = 1e-10;
  std::vector<int> plants;            ///< empty: all
  std::vector<Channel> channels;      ///< empty: all of kChannels
  bool after_switching = false;       ///< at a switching instant give the value just after it
  double lose_at = 3.14159265358979323846;  ///< pairwise rotor angle difference that ends a run [rad]
};
Trajectory run_reference(const Grid& grid, const Event& event, const ReferenceOptions& options);

}  // namespace swingbank::sim
