#include "sim/grid/operating_point.hpp"

#include "sim/grid/far.hpp"
#include "sim/grid/load_choice.hpp"

namespace swingbank::sim::grid {

Grid at_operating_point(const Grid& grid, network::Network network) {
  Grid at = grid;
  at.network = std::move(network);
  at.flow = network::solve_power_flow(at.network, at.flow_options);
  for (plant::Plant& plant : at.plants)
    plant.generation = at.flow.generation[static_cast<std::size_t>(plant.generator)];
  measure_far(at);
  Problems problems;
  for (const plant::Consumer& load : grid.loads) {
    plant::Block block = load.block;
    const std::string where = "load " + load.name;
    if (is_composed(*block.effect)) compose(at, load.load, block, where, problems);
    set_load(at, load.load, std::move(block), where, problems);
  }
  problems.raise();
  return at;
}

void set_machine_base(Grid& grid, std::size_t plant, double mva) {
  plant::Plant& p = grid.plants[plant];
  p.mva = mva;
  grid.network.generators[static_cast<std::size_t>(p.generator)].mva = mva;
  measure_far(grid);  // remote measurements are on the machine's base
}

}  // namespace swingbank::sim::grid
