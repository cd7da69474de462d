// Writes the case of tiled_grid.hpp as PSS/E files: 200 copies are 10,000 buses with 2,000 machines.
//   bench_tiled_case NETWORK.raw NETWORK.dyr COPIES OUT.raw OUT.dyr
#include <cstdio>
#include <cstdlib>

#include "sim/grid/unit.hpp"
#include "tests/bench/tiled_grid.hpp"
#include "tests/sim/formats/write_raw.hpp"

int main(int argc, char** argv) {
  using namespace swingbank;
  if (argc != 6) {
    std::fprintf(stderr, "bench_tiled_case NETWORK.raw NETWORK.dyr COPIES OUT.raw OUT.dyr\n");
    return 1;
  }
  try {
    const int tiles = std::atoi(argv[3]);
    sim::network::Network net = sim::tiled_network(argv[1], tiles);
    sim::formats::write_raw(net, argv[4]);
    const sim::grid::Grid grid = sim::grid::make_grid(
        std::move(net), sim::tiled_dynamics(argv[2], tiles, true), argv[2], sim::Conventions::psse());
    std::string dyr;
    Problems problems;
    for (const sim::plant::Plant& plant : grid.plants)
      dyr += sim::grid::unit_dyr(plant, grid.network.buses[static_cast<std::size_t>(plant.bus)].number,
                                 grid.network.generators[static_cast<std::size_t>(plant.generator)].id,
                                 plant.name, problems);
    problems.raise();
    write_text(argv[5], dyr);
    std::printf("%zu buses, %zu machines\n", grid.network.buses.size(), grid.plants.size());
  } catch (const InputError& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
