// Events other than faults and line trips, in both integrators.
#include "sim/batch/batch.hpp"
#include "sim/grid/load_choice.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::reference {
namespace {

int row_of(const Trajectory& run, Channel channel) {
  return static_cast<int>(std::ranges::find(run.channels, channel) - run.channels.begin());
}

/// Runs the event in both integrators and returns the run of the SIMD kernel.
Trajectory compared(const grid::Grid& grid, const network::Event& event,
                    double t_end = ReferenceOptions{}.t_end) {
  ReferenceOptions exact;
  exact.t_end = t_end;
  const ReferenceRun reference = run_reference(grid, event, exact);
  EXPECT_EQ(reference.outcome, Outcome::stable);
  Trajectory kept;
  batch::BatchOptions options;
  options.t_end = t_end;
  batch::Batch batch(grid, options);
  bool given = false;
  batch.run(
      [&](batch::Job& job) {
        job.event = event;
        return !std::exchange(given, true);
      },
      [&](const batch::Job&, const Trajectory& run) {
        kept = run;
        EXPECT_EQ(run.outcome, Outcome::stable);
        EXPECT_LE(test::largest_difference(run, reference), 1e-4);  // required bound
      });
  EXPECT_TRUE(given);
  return kept;
}

TEST(Events, TrippedMachineDeliversNoPowerAndTheOthersSlowDown) {
  const grid::Grid grid = test::configured_grid("ieee39_genrou", Conventions::psse());
  const auto lost = std::ranges::find(grid.plants, "30", &plant::Plant::name);
  ASSERT_NE(lost, grid.plants.end());
  network::Event event;
  event.generator_trips = {{lost->generator, 1.0}};
  const Trajectory run = compared(grid, event);
  const int plant = static_cast<int>(lost - grid.plants.begin()), last = run.samples - 1;
  EXPECT_EQ(run.at(plant, row_of(run, Channel::P))[last], 0.0);
  EXPECT_EQ(run.at(plant, row_of(run, Channel::Q))[last], 0.0);
  EXPECT_EQ(run.at(plant, row_of(run, Channel::speed))[last], 0.0);  // zero speed deviation
  for (int p = 0; p < static_cast<int>(grid.plants.size()); ++p)
    if (p != plant) {
      EXPECT_LT(run.at(p, row_of(run, Channel::speed))[240], 0.0) << grid.plants[p].name;
    }
}

double inertia(const plant::Plant& plant) {  // 2 H S [s pu of the network's base]
  const plant::Block& m = plant.machine;
  return 2 * m.p[static_cast<std::size_t>(m.effect->parameter_index("H"))] * plant.mva / 100.0;
}
/// Mean acceleration of the remaining machines, weighted by 2 H S, between two samples [1/s].
double mean_acceleration(const grid::Grid& grid, const Trajectory& run, int lost, int from, int to) {
  double sum = 0.0, weight = 0.0;
  for (int p = 0; p < static_cast<int>(grid.plants.size()); ++p) {
    if (p == lost) continue;
    const double* speed = run.at(p, row_of(run, Channel::speed));
    sum += inertia(grid.plants[static_cast<std::size_t>(p)]) * (speed[to] - speed[from]);
    weight += inertia(grid.plants[static_cast<std::size_t>(p)]);
  }
  return sum / weight * run.rate / (to - from);
}

/// The remaining machines form an aggregate with M = sum 2 H S that lacks the power P of the lost machine:
/// dw/dt = -P/M immediately after the trip.
TEST(Events, InitialFrequencyDeclineFollowsTheAggregateSwingEquation) {
  for (const char* name : {"30", "34", "37"}) {
    grid::Grid grid = test::configured_grid("ieee39_genrou", Conventions::psse());
    network::Event event;
    const auto lost = std::ranges::find(grid.plants, name, &plant::Plant::name);
    event.generator_trips = {{lost->generator, 1.0}};
    double remaining = 0.0;
    for (const plant::Plant& p : grid.plants)
      if (p.name != name) remaining += inertia(p);
    const double expected = -lost->generation.real() / remaining;
    const int index = static_cast<int>(lost - grid.plants.begin());
    const Trajectory soft = compared(grid, event, 1.5);
    Problems problems;
    for (const network::Load& l : grid.network.loads)
      grid::choose_load(
          grid, std::to_string(grid.network.buses[static_cast<std::size_t>(l.bus)].number) + ":ZIP:Pp=1,Qp=1",
          "--load", problems);
    problems.raise();
    const Trajectory hard = compared(grid, event, 1.5);
    const int at = static_cast<int>(std::lround(1.0 * hard.rate)),
              later = at + static_cast<int>(hard.rate / 10);
    // With constant-power loads only the line losses change: by 4, 0.2 and 3 MW, for lost powers of 250 to
    // 540 MW.
    EXPECT_NEAR(mean_acceleration(grid, hard, index, at, later) / expected, 1.0, 0.02) << name;
    // Constant-impedance loads fall with the voltage: the frequency declines more slowly.
    const double gentle = mean_acceleration(grid, soft, index, at, later) / expected;
    EXPECT_GT(gentle, 0.3) << name;
    EXPECT_LT(gentle, 0.97) << name;
  }
}

/// A plant of two units equals one aggregated plant: losing 40 % of it equals losing the second unit.
TEST(Events, PartialTripEqualsTheTripOfThatUnit) {
  const std::filesystem::path folder = std::filesystem::path(SWINGBANK_SOURCE) / "configs/networks";
  const auto models = formats::read_dyr(folder / "ieee39_genrou.dyr");
  const network::Network whole = formats::read_raw(folder / "ieee39_genrou.raw");
  network::Network split = whole;
  const int bus = whole.bus_index(34);
  const auto first = std::ranges::find(split.generators, bus, &network::Generator::bus);
  network::Generator second = *first;
  second.id = "2";
  const auto take = [](network::Generator& g, double part) {
    for (double* v : {&g.p, &g.q, &g.mva, &g.q_max, &g.q_min}) *v *= part;
  };
  take(*first, 0.6);
  take(second, 0.4);
  split.generators.push_back(second);
  auto both = models;
  const auto model = std::ranges::find(both, 34, &formats::DyrRecord::bus);
  both.push_back(*model);
  both.back().id = "2";
  const grid::Grid one = grid::make_grid(whole, models, "one", Conventions::psse()),
                   two = grid::make_grid(split, both, "two", Conventions::psse());
  network::Event partly, wholly;
  partly.generator_trips = {
      {static_cast<int>(std::ranges::find(whole.generators, bus, &network::Generator::bus) -
                        whole.generators.begin()),
       1.0, 0.4}};
  wholly.generator_trips = {{static_cast<int>(split.generators.size()) - 1, 1.0}};
  const Trajectory a = compared(one, partly, 3.0), b = compared(two, wholly, 3.0);
  ASSERT_EQ(two.plants.back().name, "34/2");
  const int last = a.samples - 1;
  for (std::size_t i = 0; i < one.plants.size(); ++i) {
    const int p = static_cast<int>(i), speed = row_of(a, Channel::speed), power = row_of(a, Channel::P);
    // Two runs of the SIMD kernel at 1e-6 per step.
    EXPECT_NEAR(a.at(p, speed)[last], b.at(p, speed)[last], 1e-6) << one.plants[i].name;
    // Per unit of the whole plant: the remaining part delivers 0.6 of a unit's per-unit power.
    const double left = one.plants[i].bus == bus ? 0.6 : 1.0;
    EXPECT_NEAR(a.at(p, power)[last], left * b.at(p, power)[last], 1e-5) << one.plants[i].name;
  }
}

TEST(Events, PartsOfAGeneratorAddUp) {
  const grid::Grid grid = test::two_machine_grid(Conventions::psse());
  network::Event event;
  event.generator_trips = {{1, 1.0, 0.3}, {1, 2.0, 0.5}};
  const auto list = network::segments(event, grid.network);
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[0].topology.connected(1), 1.0);
  EXPECT_NEAR(list[1].topology.connected(1), 0.7, 1e-15);
  EXPECT_NEAR(list[2].topology.connected(1), 0.2, 1e-15);
  event.generator_trips.push_back({1, 3.0});  // the rest
  EXPECT_EQ(network::segments(event, grid.network).back().topology.connected(1), 0.0);
  for (const double part : {0.0, -0.1, 1.1, 0.2}) {
    event.generator_trips = {{1, 1.0, 0.8}, {1, 2.0, part}};  // the last trip removes the remainder
    EXPECT_THROW(network::segments(event, grid.network), InputError) << part;
  }
}

TEST(Events, LoadStepDrawsItsPowerAtThePreStepVoltage) {
  const grid::Grid grid = test::two_machine_grid(Conventions::psse());
  network::Event event;
  event.load_steps = {{1, {0.05, 0.02}, 1.0, 2.0}};
  const Trajectory run = compared(grid, event);
  const int p = row_of(run, Channel::P);
  const double before = run.at(0, p)[120] + run.at(1, p)[120] * 1.5,
               after = run.at(0, p)[121] + run.at(1, p)[121] * 1.5;
  // Bases 100 and 150 MVA. The voltage drop reduces the step and the loads by a few per cent.
  EXPECT_NEAR(after - before, 0.05, 0.005);
}

}  // namespace
}  // namespace swingbank::sim::reference
