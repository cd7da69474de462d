#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/batch/batch.hpp"
#include "sim/grid/load_choice.hpp"
#include "sim/grid/operating_point.hpp"
#include "tests/bench/synthetic_grid.hpp"
#include "tests/sim/batch/run_jobs.hpp"

namespace swingbank::sim::batch {
namespace {

const grid::Grid& new_england() {
  static const grid::Grid grid =
      grid::load_grid(SWINGBANK_SOURCE "/configs/networks/ieee39_dataset_genrou.raw",
                      SWINGBANK_SOURCE "/configs/networks/ieee39_dataset_genrou.dyr", Conventions::psse());
  return grid;
}
/// Grid with the load composition of the .raw: constant power, whose current is nonlinear in the voltage.
const grid::Grid& with_load_models() {
  static const grid::Grid grid = [] {
    grid::Grid g = new_england();
    Problems problems;
    grid::loads_as_composed(g, problems);
    problems.raise();
    return g;
  }();
  return grid;
}

/// Returns a grid with other loads, dispatch, voltages and bases; some grids have one line less.
std::shared_ptr<const grid::Grid> another(const grid::Grid& grid, int number) {
  const double s = 0.7 + 0.1 * number;
  network::Network n = grid.network;
  for (auto& load : n.loads) load.power *= s;
  for (auto& g : n.generators) {
    g.p *= s * (g.bus % 2 == 0 ? 0.95 : 1.0);
    g.vset += 0.005 * (number - 1);
  }
  if (number == 2) n.branches[4].in_service = false;
  auto at = std::make_shared<grid::Grid>(grid::at_operating_point(grid, std::move(n)));
  for (std::size_t i = 0; i < at->plants.size(); ++i)
    grid::set_machine_base(*at, i, at->plants[i].mva * (0.9 + 0.2 * static_cast<double>((i + 1) % 3)));
  return at;
}

struct Mixed {
  std::vector<std::shared_ptr<const grid::Grid>> grids;
  std::vector<Job> jobs;
  explicit Mixed(const grid::Grid& grid) {
    grids = {nullptr, another(grid, 0), another(grid, 1), another(grid, 2)};
    for (int k = 0; k < 18; ++k) {
      Job job;
      job.id = static_cast<std::uint64_t>(k);
      job.event.faults = {{(7 * k) % 39, 0.2, 0.25 + 0.002 * k, {}}};
      auto p = grid.plants[static_cast<std::size_t>(k % 10)].machine.p;
      p[0] *= 1.02;
      job.parameters = {{k % 10, plant::kMachineBlock, p}};
      job.grid = grids[static_cast<std::size_t>(k % 4)];
      jobs.push_back(job);
    }
  }
};

std::map<std::uint64_t, Trajectory> run(const grid::Grid& grid, const std::vector<Job>& jobs,
                                        BatchOptions options) {
  options.t_end = 1.5;
  return run_jobs(grid, jobs, options);
}

/// Jobs of several operating points in one batch, each against a separate batch of its grid.
void expect_its_own(const grid::Grid& grid, const BatchOptions& options, double tolerance) {
  const Mixed mixed(grid);
  const auto together = run(grid, mixed.jobs, options);
  ASSERT_EQ(together.size(), mixed.jobs.size());
  for (std::size_t g = 0; g < mixed.grids.size(); ++g) {
    std::vector<Job> jobs;
    for (const Job& job : mixed.jobs)
      if (job.grid == mixed.grids[g]) {
        jobs.push_back(job);
        jobs.back().grid = {};
      }
    const grid::Grid& at = mixed.grids[g] ? *mixed.grids[g] : grid;
    for (const auto& [id, t] : run(at, jobs, options)) {
      EXPECT_EQ(t.outcome, together.at(id).outcome) << id;
      const auto x = t.packed(), y = together.at(id).packed();
      double largest = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) largest = std::max(largest, std::abs(x[i] - y[i]));
      EXPECT_LE(largest, tolerance) << id;
    }
  }
}

TEST(OperatingStates, MixedBatchEqualsSeparateBatches) {
  for (const int lanes : {1, 4, 8}) {
    BatchOptions options;
    options.lanes = lanes;
    expect_its_own(new_england(), options, 0.0);  // to the last bit
  }
}

TEST(OperatingStates, MixedBatchEqualsSeparateBatchesWithLoadModels) {
  expect_its_own(with_load_models(), {}, 1e-12);
}

/// With many sources, the lanes of a batch share the matrix of a grid. The matrix differs between operating
/// points, and therefore the rounding.
TEST(OperatingStates, MixedBatchEqualsSeparateBatchesWithManySources) {
  static const grid::Grid grid = synthetic(41);
  const Mixed mixed(grid);
  BatchOptions one;
  one.lanes = 1;  // no shared network
  const auto a = run(grid, mixed.jobs, one), b = run(grid, mixed.jobs, {});
  for (const auto& [id, t] : a) {
    const auto x = t.packed(), y = b.at(id).packed();
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(x[i], y[i], 1e-9) << id;
  }
}

TEST(OperatingStates, StaySteadyUntilTheFault) {
  const Mixed mixed(new_england());
  for (const auto& [id, t] : run(new_england(), mixed.jobs, {}))
    for (int p = 0; p < 10; ++p)
      for (int k = 0; k < 24; ++k)
        ASSERT_NEAR(t.at(p, static_cast<int>(Channel::speed))[k], 0.0, 1e-12) << id;
}

}  // namespace
}  // namespace swingbank::sim::batch
