#include "sim/grid/operating_point.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "sim/grid/load_choice.hpp"
#include "sim/network/admittance.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::grid {
namespace {

using ::testing::HasSubstr;

Grid ieee39() {
  const std::string file = SWINGBANK_SOURCE "/configs/networks/ieee39_dataset_genrou";
  return load_grid(file + ".raw", file + ".dyr", Conventions::psse());
}

network::Network scaled(network::Network n, double s) {
  for (auto& load : n.loads) {
    load.power *= s;
    load.current *= s;
    load.admittance *= s;
  }
  for (auto& g : n.generators) g.p *= s;
  return n;
}

TEST(AnotherOperatingPoint, OfTheSameNetworkIsUnchanged) {
  const Grid grid = ieee39(), again = at_operating_point(grid, grid.network);
  EXPECT_EQ(again.flow.voltage, grid.flow.voltage);
  for (std::size_t i = 0; i < grid.plants.size(); ++i)
    EXPECT_EQ(again.plants[i].generation, grid.plants[i].generation);
}

TEST(AnotherOperatingPoint, PlantsFollowThePowerFlow) {
  const Grid grid = ieee39(), at = at_operating_point(grid, scaled(grid.network, 0.8));
  for (std::size_t i = 0; i < at.plants.size(); ++i) {
    EXPECT_EQ(at.plants[i].generation, at.flow.generation[static_cast<std::size_t>(at.plants[i].generator)]);
    if (grid.network.buses[static_cast<std::size_t>(at.plants[i].bus)].type != network::BusType::slack) {
      EXPECT_NEAR(at.plants[i].generation.real(), 0.8 * grid.plants[i].generation.real(), 1e-12);
    }
    EXPECT_EQ(at.plants[i].machine.p, grid.plants[i].machine.p);
    EXPECT_EQ(at.plants[i].mva, grid.plants[i].mva);
  }
}

/// A load model's values from the .raw depend on the voltage and are computed again; given values are kept.
TEST(AnotherOperatingPoint, LoadsWithAModelFollowToo) {
  formats::RawCase raw;
  raw.loads = "103,'1',1,1,1,150.0,30.0,50.0,-5.0,0,0,1,1,0\n103,'2',1,1,1,50.0,10.0,0,0,0,0,1,1,0\n";
  const formats::ScratchFile r("case.raw", raw.text()),
      d("case.dyr",
        "101 'GENCLS' 1 3.0 0.0 /\n102 'GENCLS' 1 3.0 0.0 /\n103 'LDFRBL' '1' 1.5 -1 0.5 0.25 /\n");
  Grid grid = load_grid(r.path, d.path, Conventions::psse());
  Problems problems;
  choose_load(grid, "103/2:ZIP:Pp=0.4", "test", problems);
  problems.raise();
  const Grid at = at_operating_point(grid, scaled(grid.network, 0.8));
  ASSERT_EQ(at.loads.size(), 2u);
  const double v = std::abs(at.flow.voltage[2]), before = std::abs(grid.flow.voltage[2]);
  ASSERT_GT(v, before + 1e-3);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(at.loads[i].consumption,
              network::consumption(at.network.loads[static_cast<std::size_t>(at.loads[i].load)], at.flow));
  const auto part = [](const plant::Consumer& load) {
    return load.block.p[static_cast<std::size_t>(load.block.effect->parameter_index("Pp"))];
  };
  EXPECT_NEAR(part(at.loads[0]), 150.0 / (150.0 + 50.0 * v), 1e-12);
  EXPECT_EQ(part(at.loads[1]), 0.4);
}

TEST(AnotherOperatingPoint, MachineBaseDoesNotChangeThePower) {
  Grid grid = ieee39();
  const plant::Plant before = grid.plants[3];
  set_machine_base(grid, 3, 2.0 * before.mva);
  const auto steady = [&](const plant::Plant& plant) {
    return plant::operating_point(plant, grid.flow.voltage[static_cast<std::size_t>(plant.bus)],
                                  grid.network.base_mva, grid.conventions);
  };
  EXPECT_EQ(grid.plants[3].generation, before.generation);
  EXPECT_EQ(grid.network.generators[static_cast<std::size_t>(before.generator)].mva, 2.0 * before.mva);
  EXPECT_NEAR(steady(grid.plants[3]).s.P, 0.5 * steady(before).s.P, 1e-12);  // per unit on its own base
}

TEST(AnotherOperatingPoint, IsRefusedWithoutAPowerFlow) {
  const Grid grid = ieee39();
  EXPECT_THAT(formats::sentences_of([&] { at_operating_point(grid, scaled(grid.network, 20.0)); }),
              HasSubstr("the power flow diverges"));
}

}  // namespace
}  // namespace swingbank::sim::grid
