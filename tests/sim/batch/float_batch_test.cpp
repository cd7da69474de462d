// SIMD batches of sixteen float lanes (decision 02) against eight double lanes: switching, steps, outages and
// refusals. The results do not depend on the other events of the batch, to the last bit.
// all_effects_against_reference_test.cpp compares float results with the reference.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "sim/batch/batch.hpp"
#include "sim/grid/load_choice.hpp"
#include "sim/library/library.hpp"
#include "tests/bench/synthetic_grid.hpp"
#include "tests/sim/batch/random_grids.hpp"
#include "tests/sim/batch/run_jobs.hpp"

namespace swingbank::sim::batch {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kFloatLimit = 1e-4;  ///< required limit, relative to max(1 pu, the swing)

grid::Grid round_rotors() { return test::configured_grid("ieee39_dataset_genrou", Conventions::psse()); }

/// A governor, a stabiliser and an exciter on every machine.
grid::Grid with_controls() {
  grid::Grid grid = round_rotors();
  for (plant::Plant& plant : grid.plants)
    for (const char* name : {"TGOV1", "IEEEST", "SEXS"}) {
      const Effect& e = *library::compiled().find(name);
      plant.controls.push_back({&e, e.default_parameters()});
    }
  return grid;
}

std::vector<Job> faults_on(const grid::Grid& grid, int count) {
  std::mt19937_64 random(45);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  std::vector<Job> jobs(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    jobs[i].id = i;
    const auto bus = static_cast<int>(random() % grid.network.buses.size());
    jobs[i].event.faults = {{bus, 1.0, 1.0 + uniform(0.03, 0.12), {}}};
    auto p = grid.plants[i % grid.plants.size()].machine.p;
    for (auto& v : p) v *= uniform(0.97, 1.03);
    jobs[i].parameters = {{static_cast<int>(i % grid.plants.size()), plant::kMachineBlock, p}};
  }
  return jobs;
}

std::map<std::uint64_t, Trajectory> run_batch(const grid::Grid& grid, const std::vector<Job>& jobs,
                                              int lanes) {
  BatchOptions options;
  options.t_end = 6.0;
  options.lanes = lanes;
  return run_jobs(grid, jobs, options);
}

/// Compares the events that are stable in both precisions; returns their number.
int agree(const grid::Grid& grid, const std::vector<Job>& jobs) {
  const auto doubles = run_batch(grid, jobs, 8), floats = run_batch(grid, jobs, 16);
  int compared = 0;
  for (const Job& job : jobs) {
    const Trajectory &a = floats.at(job.id), &b = doubles.at(job.id);
    EXPECT_EQ(a.outcome, b.outcome) << job.id;
    if (a.outcome != Outcome::stable || b.outcome != Outcome::stable) continue;
    ++compared;
    const test::Difference d = test::difference(grid, job.event, a, b);
    EXPECT_LE(d.value, kFloatLimit) << d.where << ", event " << job.id;
  }
  return compared;
}

TEST(FloatBatch, AgreeWithDoublesOnRandomFaults) {
  EXPECT_GT(agree(round_rotors(), faults_on(round_rotors(), 20)), 10);
  EXPECT_GT(agree(with_controls(), faults_on(with_controls(), 20)), 10);
}

TEST(FloatBatch, AgreeWithDoublesOnOtherEvents) {
  grid::Grid grid = with_controls();
  const Effect &step = *library::compiled().find("VREFSTEP"), &ramp = *library::compiled().find("PREFRAMP");
  grid.plants[2].controls.insert(grid.plants[2].controls.begin(), {&step, step.default_parameters()});
  grid.plants[5].controls.insert(grid.plants[5].controls.begin(), {&ramp, ramp.default_parameters()});
  std::vector<Job> jobs(4);
  for (std::size_t i = 0; i < jobs.size(); ++i) jobs[i].id = i;
  jobs[0].event.trips = {{3, 1.0, {}}};
  jobs[1].event.generator_trips = {{grid.plants[4].generator, 1.0}};
  jobs[2].event.load_steps = {{7, {0.4, 0.1}, 1.0, 2.0}};
  jobs[3].event.setpoint_steps = {{grid.plants[1].generator, 1.5, 0.01, 0.02}};
  EXPECT_EQ(agree(grid, jobs), 4);
}

TEST(FloatBatch, AgreeWithDoublesOnASharedNetwork) {
  const grid::Grid grid = synthetic(41);
  EXPECT_GT(agree(grid, faults_on(grid, 16)), 8);
}

TEST(FloatBatch, ARecordDoesNotDependOnItsLaneOrNeighbours) {
  const grid::Grid grid = with_controls();
  auto jobs = faults_on(grid, 20);
  const auto forward = run_batch(grid, jobs, 16);
  std::reverse(jobs.begin(), jobs.end());
  const auto backward = run_batch(grid, jobs, 16);
  for (const Job& job : jobs) {
    EXPECT_EQ(forward.at(job.id).packed(), backward.at(job.id).packed()) << job.id;  // to the last bit
    EXPECT_EQ(forward.at(job.id).packed(), run_batch(grid, {job}, 16).at(job.id).packed()) << job.id;
  }
}

TEST(FloatBatch, RefuseUnsupportedRuns) {
  grid::Grid grid = round_rotors();
  const auto block = [](const Effect& e) { return plant::Block{&e, e.default_parameters()}; };
  grid.plants[3].machine = block(*library::compiled().find("GENTPJ"));
  Effect user_model = *library::compiled().find("SEXS");
  user_model.name = "OWNLAW";
  user_model.user_model = std::make_shared<int>(0);
  grid.plants[4].controls.push_back(block(user_model));
  Problems problems;
  grid::set_load(grid, 0, block(*library::compiled().find("ZIP")), "here", problems);
  problems.raise();
  BatchOptions options;
  options.lanes = 16;
  try {
    Batch(grid, options);
    ADD_FAILURE() << "not refused";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("GENTPJ at"), HasSubstr("OWNLAW at"), HasSubstr("ZIP at"),
                                HasSubstr("choose 8 lanes")));
  }
}

TEST(FloatBatch, AreNamedInTheVariant) {
  BatchOptions options;
  options.lanes = 16;
  EXPECT_THAT(Batch(round_rotors(), options).variant(), HasSubstr("lanes=16 float"));
}

}  // namespace
}  // namespace swingbank::sim::batch
