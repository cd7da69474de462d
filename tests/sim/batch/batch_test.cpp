#include "sim/batch/batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "tests/sim/batch/run_jobs.hpp"

namespace swingbank::sim::batch {
namespace {

const grid::Grid& ieee39() {
  static const grid::Grid grid =
      grid::load_grid(SWINGBANK_SOURCE "/configs/networks/ieee39_genrou.raw",
                      SWINGBANK_SOURCE "/configs/networks/ieee39_genrou.dyr", Conventions::psse());
  return grid;
}

std::vector<Job> random_jobs(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  std::vector<Job> jobs(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    jobs[i].id = i;
    jobs[i].event.faults.push_back({static_cast<int>(u(random) * 39), 0.5, 0.55 + 0.15 * u(random), {}});
    auto p = ieee39().plants[i % 10].machine.p;
    for (auto& v : p) v *= 0.97 + 0.06 * u(random);
    jobs[i].parameters.push_back({static_cast<int>(i % 10), plant::kMachineBlock, p});
  }
  return jobs;
}

std::map<std::uint64_t, Trajectory> run(const std::vector<Job>& jobs, BatchOptions options) {
  options.t_end = 3.0;
  return run_jobs(ieee39(), jobs, options);
}

TEST(BatchKernel, ARecordDoesNotDependOnItsLaneOrNeighbours) {
  auto jobs = random_jobs(40, 1);
  const auto forward = run(jobs, {});
  std::reverse(jobs.begin(), jobs.end());
  const auto backward = run(jobs, {});
  ASSERT_EQ(forward.size(), jobs.size());
  for (const auto& job : jobs) {
    const auto alone = run({job}, {});
    const auto& a = forward.at(job.id);
    EXPECT_EQ(a.packed(), backward.at(job.id).packed()) << job.id;  // to the last bit
    EXPECT_EQ(a.packed(), alone.at(job.id).packed()) << job.id;
    EXPECT_EQ(a.outcome, alone.at(job.id).outcome);
  }
}

TEST(BatchKernel, EveryWidthGivesTheSameRecord) {
  const auto jobs = random_jobs(24, 2);
  BatchOptions scalar, four, eight;
  scalar.lanes = 1;
  four.lanes = 4;
  eight.lanes = 8;
  const auto a = run(jobs, scalar), b = run(jobs, four), c = run(jobs, eight);
  int compared = 0;
  for (const auto& [id, t] : a) {
    EXPECT_EQ(t.outcome, c.at(id).outcome);
    if (t.outcome != Outcome::stable) continue;
    ++compared;
    const auto x = t.packed(), y = b.at(id).packed(), z = c.at(id).packed();
    for (std::size_t i = 0; i < x.size(); ++i) {
      // Rounding differs (sincos of packs); portable builds guarantee 1e-9.
      ASSERT_NEAR(x[i], y[i], 1e-9) << id;
      ASSERT_NEAR(x[i], z[i], 1e-9) << id;
    }
  }
  EXPECT_GT(compared, 10);
}

TEST(BatchKernel, StaysSteadyWithoutAnEvent) {
  std::vector<Job> jobs(1);
  const auto t = run(jobs, {}).at(0);
  EXPECT_EQ(t.outcome, Outcome::stable);
  for (std::size_t k = 0; k < t.plants.size(); ++k)
    for (std::size_t c = 0; c < t.channels.size(); ++c) {
      const double* v = t.at(static_cast<int>(k), static_cast<int>(c));
      EXPECT_EQ(*std::min_element(v, v + t.samples), *std::max_element(v, v + t.samples));
    }
  const double* p = t.at(0, 2);  // P of generator 30 [pu on 100 MVA: 2.5] on its own base
  EXPECT_NEAR(p[0] * ieee39().plants[0].mva / 100.0, 2.5, 1e-9);
}

TEST(BatchKernel, TheSampleAtASwitchingIsTheValueJustBefore) {
  auto jobs = random_jobs(1, 3);
  jobs[0].event.faults[0] = {ieee39().plants[2].bus, 0.5, 0.6, {}};  // at the terminal of plant 2
  BatchOptions options;
  options.plants = {2};
  options.channels = {Channel::V, Channel::theta};
  const auto t = run(jobs, options).at(0);
  const double* v = t.at(0, 0);
  const double* theta = t.at(0, 1);
  EXPECT_GT(v[60], 0.9);           // t = 0.5 s: still before the fault
  EXPECT_NEAR(v[61], 0.0, 1e-11);  // bolted: V = 0
  EXPECT_NEAR(v[72], 0.0, 1e-11);  // t = 0.6 s: still faulted
  EXPECT_GT(v[73], 0.5);
  for (int k = 61; k <= 72; ++k) EXPECT_EQ(theta[k], theta[60]) << "theta must keep its value while V = 0";
}

TEST(BatchKernel, LostRunIsReportedAndKeepsItsLastSample) {
  auto jobs = random_jobs(1, 4);
  jobs[0].event.faults[0] = {ieee39().network.bus_index(16), 0.5, 1.5, {}};  // 1 s at a central bus
  const auto t = run(jobs, {}).at(0);
  EXPECT_EQ(t.outcome, Outcome::lost_synchronism);
  EXPECT_GT(t.largest_spread, 3.14159);
  EXPECT_LT(t.stopped_at, 3.0);
  for (double v : t.packed()) ASSERT_TRUE(std::isfinite(v));
}

TEST(BatchKernel, AngleSpreadIsMeasuredFromTheStart) {
  auto jobs = random_jobs(1, 4);
  jobs[0].event.faults[0] = {ieee39().network.bus_index(16), 0.5, 0.501, {}};  // 1 ms: hardly a swing
  BatchOptions options;
  EXPECT_LT(run(jobs, options).at(0).largest_spread, 0.1);
  options.lose_at = 0.1;  // less than the rotor angle spread in steady state
  EXPECT_EQ(run(jobs, options).at(0).outcome, Outcome::stable);
}

TEST(BatchKernel, AnUnknownWidthIsRefused) {
  BatchOptions options;
  options.lanes = 3;
  EXPECT_THROW(Batch(ieee39(), options), InputError);
}

}  // namespace
}  // namespace swingbank::sim::batch
