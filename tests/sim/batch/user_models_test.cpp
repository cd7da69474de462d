// User-defined models in the SIMD kernel: against the compiled effect, in every kernel, and against the
// reference integrator.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sim/batch/batch.hpp"
#include "sim/library/library.hpp"
#include "sim/user_models/user_model.hpp"
#include "tests/sim/user_models/on_a_grid.hpp"
#include "tests/sim/user_models/support.hpp"

namespace swingbank::sim::batch {
namespace {

Trajectory batch_run(const grid::Grid& grid, int lanes, double tolerance = 1e-6) {
  BatchOptions options;
  options.t_end = 5.0;
  options.lanes = lanes;
  options.tolerance = tolerance;
  options.plants = {1};
  Batch batch(grid, options);
  Trajectory run;
  bool given = false;
  batch.run([&](Job& job) { return job.event = test::kFault, !std::exchange(given, true); },
            [&](const Job&, const Trajectory& t) { run = t; });
  return run;
}

TEST(UserModelInBatch, SexsAsUserDefinedModelEqualsTheCompiledOne) {
  const std::vector<std::vector<double>> sets = {{0.1, 10.0, 100.0, 0.1, -4.0, 5.0},   // reaches the ceiling
                                                 {0.5, 2.0, 20.0, 0.05, -10.0, 10.0},  // does not reach it
                                                 {1.0, 0.0, 50.0, 0.2, -4.0, 4.0}};    // lead-lag bypassed
  bool reached = false;
  for (const auto& p : sets) {
    const grid::Grid compiled = test::with_exciter(*library::compiled().find("SEXS"), p),
                     user_model = test::with_exciter(test::sexs_user_model(), p);
    for (const int lanes : {1, 4, 8}) {
      const Trajectory a = batch_run(compiled, lanes), b = batch_run(user_model, lanes);
      EXPECT_LE(test::largest_difference(a, b), 1e-10) << lanes;  // the same arithmetic in the same order
      const double* efd = a.at(0, static_cast<int>(Channel::Efd));
      reached = reached || *std::max_element(efd, efd + a.samples) == p[5];
    }
    // The compiler uses fused multiply-adds, the interpreter rounds twice. IDA then takes other steps, so its
    // tolerance is far below the compared difference.
    EXPECT_LE(test::largest_difference(test::reference_run(compiled, 1e-12),
                                       test::reference_run(user_model, 1e-12)),
              1e-10);
  }
  EXPECT_TRUE(reached);
}

grid::Grid nonlinear_grid() {
  grid::Grid grid =
      test::with_exciter(*library::compiled().find("SEXS"), {0.5, 2.0, 20.0, 0.05, -10.0, 10.0});
  const Effect& user_model = user_models::load_user_model(test::kNonlinear, "n", grid.library);
  grid.plants[1].controls.insert(grid.plants[1].controls.begin(),
                                 {&user_model, user_model.default_parameters()});
  return grid;
}

TEST(UserModelInBatch, NonlinearModelRunsInEveryKernel) {
  const grid::Grid grid = nonlinear_grid();
  const auto at = plant::operating_point(grid.plants[1], grid.flow.voltage[2], 100.0, grid.conventions);
  EXPECT_NEAR(at.x[7], std::sqrt(at.s.V), 1e-12);  // six states of the machine, x, then the root
  const Trajectory one = batch_run(grid, 1), eight = batch_run(grid, 8), four = batch_run(grid, 4);
  // Packs have their own sincos, 2 ulp off; adaptive steps propagate the difference.
  EXPECT_LE(test::largest_difference(one, eight), 1e-10);
  EXPECT_LE(test::largest_difference(one, four), 1e-10);
  // The model has kinks that no integrator locates; hence smaller steps than usual.
  EXPECT_LE(test::largest_difference(batch_run(grid, 8, 1e-10), test::reference_run(grid, 1e-11)), 1e-5);
  grid::Grid without = grid;
  without.plants[1].controls.erase(without.plants[1].controls.begin());
  EXPECT_GT(test::largest_difference(one, batch_run(without, 1)), 1e-2);  // the model has an effect
}

TEST(UserModelInBatch, PlantWithAnExampleStaysSteadyAndRidesThroughAFault) {
  int count = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(SWINGBANK_SOURCE) + "/configs/user_models")) {
    if (file.path().extension() != ".toml") continue;
    library::EffectLibrary library;
    const Effect& user_model = user_models::load_user_model(file.path(), library);
    grid::Grid grid =
        test::with_exciter(*library::compiled().find("SEXS"), {0.5, 2.0, 20.0, 0.05, -10.0, 10.0});
    auto& controls = grid.plants[1].controls;
    if (user_model.slot == Slot::exciter) controls.clear();
    controls.push_back({&user_model, user_model.default_parameters()});
    std::ranges::stable_sort(controls, {}, [](const plant::Block& b) { return b.effect->slot; });
    const Trajectory run = batch_run(grid, 8);
    EXPECT_EQ(run.outcome, Outcome::stable) << file.path();
    EXPECT_LE(test::largest_difference(run, test::reference_run(grid)), 1e-4)
        << file.path();  // guaranteed by the kernel
    ++count;
  }
  EXPECT_GE(count, 4);
}

}  // namespace
}  // namespace swingbank::sim::batch
