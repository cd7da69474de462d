// Static var compensator at a switched shunt in the SIMD kernel against the reference integrator, through
// nearby faults and its protection; unsupported remote regulation is refused.
#include <gmock/gmock.h>

#include <iostream>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "sim/batch/batch.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/batch/random_grids.hpp"
#include "tests/sim/batch/run_jobs.hpp"

namespace swingbank::sim::batch::static_var {
namespace {

using Values = std::map<std::string, double>;
constexpr double kCompensatorLimit = 1e-4;  ///< relative to max(1 pu, the channel's swing)
constexpr int kShuntBus = 1;                ///< in the middle between two machines

grid::Grid with_compensator(const Values& changes, double susceptance) {
  grid::Grid grid = test::two_machine_grid(Conventions::psse());
  network::Load shunt;
  shunt.bus = kShuntBus;
  shunt.id = "SW";
  shunt.admittance = {0.0, -susceptance};
  shunt.kind = network::LoadKind::shunt;
  grid.network.loads.push_back(shunt);
  grid.flow = network::solve_power_flow(grid.network);
  for (plant::Plant& plant : grid.plants)
    plant.generation = grid.flow.generation[static_cast<std::size_t>(plant.generator)];
  const Effect& effect = *library::compiled().find("SVSMO1");
  plant::Block block{&effect, effect.default_parameters()};
  for (const auto& [parameter, value] : changes)
    block.p.at(static_cast<std::size_t>(effect.parameter_index(parameter))) = value;
  Problems problems;
  grid::set_load(grid, static_cast<int>(grid.network.loads.size()) - 1, block, "test", problems);
  problems.raise();
  return grid;
}

std::vector<network::Event> events() {
  std::vector<network::Event> all(4);
  all[0].faults = {{kShuntBus, 1.0, 1.1, {}}};
  all[1].faults = {{kShuntBus, 1.0, 1.3, {0.0, 0.1}}};
  all[2].faults = {{kShuntBus, 1.0, 2.0, {0.0, 0.5}}};
  all[3].load_steps = {{kShuntBus, {0.3, 0.2}, 1.0, {}}};
  return all;
}

TEST(StaticVarBatch, FollowTheReference) {
  const Values low = {{"UV1", 0.75}, {"UVtm1", 0.1}, {"PLLdelay", 0.2}, {"UVSBmax", 0.1},
                      {"Bmax", 0.4}, {"Bshrt", 0.6}, {"Bmin", -0.3},    {"Tshrt", 0.3}};
  const Values trips = {{"UVT", 0.6}, {"UVtm2", 0.15}, {"Bmax", 0.4}, {"Bshrt", 0.6}, {"Bmin", -0.3}};
  const Values sleeps = {{"Vdbd1", 0.01}, {"Vdbd2", 0.004}, {"Tdbd", 0.1}, {"Kpv", 5.0}, {"Kiv", 20.0}};
  for (const auto& [name, values, susceptance] :
       std::vector<std::tuple<std::string, Values, double>>{{"at nothing", {}, 0.0},
                                                            {"limits", low, 0.2},
                                                            {"trips", trips, 0.2},
                                                            {"dead-band", sleeps, -0.1}}) {
    const grid::Grid grid = with_compensator(values, susceptance);
    const auto all = events();
    BatchOptions options;
    options.t_end = 4.0;
    options.rate = 60.0;
    const auto runs = run_events(grid, all, options);
    for (std::size_t e = 0; e < all.size(); ++e) {
      reference::ReferenceOptions exact;
      exact.t_end = options.t_end;
      exact.rate = options.rate;
      const reference::ReferenceRun expected = reference::run_reference(grid, all[e], exact);
      ASSERT_EQ(expected.outcome, Outcome::stable) << name << " event " << e;
      ASSERT_EQ(runs.at(e).outcome, Outcome::stable) << name << " event " << e;
      const auto d = test::difference(grid, all[e], runs.at(e), expected);
      std::cout << name << " event " << e << ": " << d.value << " " << d.where << "\n";
      EXPECT_LT(d.value, kCompensatorLimit) << name << " event " << e << ": " << d.where;
    }
  }
}

TEST(StaticVarBatch, RefuseRemoteRegulation) {
  grid::Grid grid = with_compensator({}, 0.1);
  grid.loads[0].regulated = kShuntBus;
  EXPECT_NO_THROW(Batch(grid, {}));
  grid.loads[0].regulated = kShuntBus + 1;
  try {
    Batch batch(grid, {});
    ADD_FAILURE() << "taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("regulates bus"));
    EXPECT_THAT(error.what(), testing::HasSubstr("use the reference integrator"));
  }
}

}  // namespace
}  // namespace swingbank::sim::batch::static_var
