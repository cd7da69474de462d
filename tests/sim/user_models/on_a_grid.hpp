#pragma once
// Plant with a user-defined or compiled exciter, and a fault nearby.
#include <utility>
#include <vector>

#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::test {

inline grid::Grid with_exciter(const Effect& exciter, std::vector<double> p) {
  grid::Grid grid = two_machine_grid(Conventions::psse());
  grid.plants[1].controls = {{&exciter, std::move(p)}};
  return grid;
}
inline const network::Event kFault{{{1, 0.5, 0.65, {0.0, 0.05}}}, {}};
inline reference::ReferenceRun reference_run(const grid::Grid& grid, double rtol = 1e-8) {
  reference::ReferenceOptions options;
  options.t_end = 5.0;
  options.rtol = rtol;
  options.atol = rtol / 100;
  options.plants = {1};  // plant 0 is behind 1e-4 pu, which amplifies the rounding of its voltage
  return reference::run_reference(grid, kFault, options);
}

}  // namespace swingbank::sim::test
