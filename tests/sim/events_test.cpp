// Events other than faults and line trips, in both integrators.
#include "reference_support.hpp"
#include "sim/solve/batch.hpp"

namespace swingbank::sim {
namespace {

int row_of(const Trajectory& run, Channel channel) {
  return static_cast<int>(std::ranges::find(run.channels, channel) - run.channels.begin());
}

/// Runs the event in both integrators and returns the lanes' run.
Trajectory compared(const Grid& grid, const Event& event) {
  const ReferenceRun reference = run_reference(grid, event, {});
  EXPECT_EQ(reference.outcome, Outcome::stable);
  Trajectory kept;
  Batch batch(grid, BatchOptions{});
  bool given = false;
  batch.run(
      [&](Job& job) {
        job.event = event;
        return !std::exchange(given, true);
      },
      [&](const Job&, const Trajectory& run) {
        kept = run;
        EXPECT_EQ(run.outcome, Outcome::stable);
        EXPECT_LE(test::largest_difference(run, reference), 1e-4);  // the bound
      });
  EXPECT_TRUE(given);
  return kept;
}

TEST(Events, ATrippedMachineDeliversNothingAndTheOthersSlowDown) {
  const Grid grid = test::configured_grid("ieee39_genrou", Conventions::psse());
  const auto lost = std::ranges::find(grid.plants, "30", &Plant::name);
  ASSERT_NE(lost, grid.plants.end());
  Event event;
  event.generator_trips = {{lost->generator, 1.0}};
  const Trajectory run = compared(grid, event);
  const int plant = static_cast<int>(lost - grid.plants.begin()), last = run.samples - 1;
  EXPECT_EQ(run.at(plant, row_of(run, Channel::P))[last], 0.0);
  EXPECT_EQ(run.at(plant, row_of(run, Channel::Q))[last], 0.0);
  EXPECT_EQ(run.at(plant, row_of(run, Channel::speed))[last], 0.0);  // stands still
  for (int p = 0; p < static_cast<int>(grid.plants.size()); ++p)
    if (p != plant) {
      EXPECT_LT(run.at(p, row_of(run, Channel::speed))[240], 0.0) << grid.plants[p].name;
    }
}

TEST(Events, ALoadStepTakesThePowerItNamesAtTheVoltageBefore) {
  const Grid grid = test::two_machine_grid(Conventions::psse());
  Event event;
  event.load_steps = {{1, {0.05, 0.02}, 1.0, 2.0}};
  const Trajectory run = compared(grid, event);
  const int p = row_of(run, Channel::P);
  const double before = run.at(0, p)[120] + run.at(1, p)[120] * 1.5,
               after = run.at(0, p)[121] + run.at(1, p)[121] * 1.5;
  // Bases 100 and 150 MVA. What the voltage gives way takes a few per cent of the step, of the loads too.
  EXPECT_NEAR(after - before, 0.05, 0.005);
}

}  // namespace
}  // namespace swingbank::sim
