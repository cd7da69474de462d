// Forward sensitivities of the SIMD kernel against two other methods: central differences of the plain
// kernel, and SUNDIALS CVODES with difference quotients on the same reduced equations. For all effects:
// all_sensitivities_test.cpp.
#include "tests/sim/batch/reduced_system.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::batch {
namespace {

using test::configured_grid;

BatchOptions sensitive(double tolerance) {
  BatchOptions options;
  options.t_end = 3.0;
  options.rate = 60.0;
  options.tolerance = tolerance;
  options.channels = {Channel::delta, Channel::speed, Channel::P, Channel::Q, Channel::Ifd};
  options.sensitivities = true;
  return options;
}
Trajectory play_one(const grid::Grid& grid, const BatchOptions& options, const Job& job) {
  Batch batch(grid, options);
  Trajectory result;
  bool given = false;
  batch.run([&](Job& next) { return !std::exchange(given, true) && (next = job, true); },
            [&](const Job&, const Trajectory& t) { result = t; });
  return result;
}
std::vector<Seed> seeds(const grid::Grid& grid, int plant, const std::vector<const char*>& names) {
  std::vector<Seed> list;
  const plant::Block& machine = grid.plants[static_cast<std::size_t>(plant)].machine;
  for (const char* name : names) {
    const int index = machine.effect->parameter_index(name);
    list.push_back({plant,
                    {plant::kMachineBlock, index},
                    std::max(0.1, std::abs(machine.p[static_cast<std::size_t>(index)]))});
  }
  return list;
}
network::Event fault(const grid::Grid& grid, int bus) {
  network::Event event;
  event.faults.push_back({grid.network.bus_index(bus), 0.2, 0.3, {}});
  return event;
}

/// Largest difference of a column from `other`, over the column's largest value.
double worst_column(const Trajectory& t, int parameter, const std::vector<double>& other, int row) {
  const auto channels = static_cast<int>(t.channels.size());
  const double* own = t.sensitivity(parameter, row / channels, row % channels);
  double largest = 0.0, worst = 0.0;
  for (int k = 0; k < t.samples; ++k)
    largest = std::max(largest, std::abs(other[static_cast<std::size_t>(k)]));
  for (int k = 0; k < t.samples; ++k)
    worst = std::max(worst, std::abs(own[k] - other[static_cast<std::size_t>(k)]));
  return largest > 0.0 ? worst / largest : worst;
}

TEST(Sensitivities, EqualCentralDifferences) {
  const grid::Grid grid = configured_grid("ieee39_genrou", Conventions::psse());
  constexpr int plant = 4;
  Job job;
  job.event = fault(grid, 16);
  job.seeds = seeds(grid, plant, {"H", "D", "Xd", "Xdp", "Xdpp", "Tdop", "S10", "Ra"});
  BatchOptions options = sensitive(1e-9);
  options.plants = {plant, 0};
  const Trajectory dual = play_one(grid, options, job);
  ASSERT_EQ(dual.outcome, Outcome::stable);
  options.sensitivities = false;
  options.tolerance = 1e-11;  // so that its error, divided by the step below, stays under 1e-6
  for (std::size_t d = 0; d < job.seeds.size(); ++d) {
    const Seed& seed = job.seeds[d];
    const double h = 1e-4 * seed.scale;
    Trajectory side[2];
    for (int s = 0; s < 2; ++s) {
      Job moved;
      moved.event = job.event;
      auto p = grid.plants[plant].machine.p;
      p[static_cast<std::size_t>(seed.parameter.index)] += s == 0 ? h : -h;
      moved.parameters.push_back({plant, plant::kMachineBlock, p});
      side[s] = play_one(grid, options, moved);
    }
    const bool at_edge = plant::parameter_value(grid.plants[plant], seed.parameter) == 0.0 &&
                         plant::parameter_record(grid.plants[plant], seed.parameter).name == "S10";
    if (at_edge) continue;  // no saturation in this file: not differentiable at its onset
    for (int row = 0; row < dual.rows(); ++row) {
      std::vector<double> quotient(static_cast<std::size_t>(dual.samples));
      for (int k = 0; k < dual.samples; ++k)
        quotient[static_cast<std::size_t>(k)] =
            (side[0].row(row)[k] - side[1].row(row)[k]) / (2 * h) * seed.scale;
      // required limit; the quotient's third-order term is 1e-8 relative, the integrators' errors 1e-7
      EXPECT_LT(worst_column(dual, static_cast<int>(d), quotient, row), 1e-5)
          << "row " << row << " by "
          << grid.plants[plant]
                 .machine.effect->parameters[static_cast<std::size_t>(seed.parameter.index)]
                 .name;
    }
  }
}

TEST(Sensitivities, ValuesAreThoseOfThePlainKernel) {
  const grid::Grid grid = configured_grid("ieee39_genrou", Conventions::psse());
  Job job;
  job.event = fault(grid, 4);
  job.seeds = seeds(grid, 2, {"H", "Xd"});
  BatchOptions options = sensitive(1e-9);
  const Trajectory dual = play_one(grid, options, job);
  options.sensitivities = false;
  const Trajectory plain = play_one(grid, options, job);
  for (int row = 0; row < plain.rows(); ++row)
    for (int k = 0; k < plain.samples; ++k)  // other steps, with an error of 1e-9 per step
      EXPECT_NEAR(dual.row(row)[k], plain.row(row)[k], 1e-6);
}

TEST(Sensitivities, EqualThoseOfCvodes) {
  const grid::Grid grid = configured_grid("ieee14_genrou", Conventions::psse());
  Job job;
  job.event.trips.push_back({grid.network.branch_index(2, 3, "1"), 0.0, {}});  // no later switching
  ASSERT_GE(job.event.trips[0].branch, 0);
  job.seeds = seeds(grid, 1, {"H", "Tdop", "Xdp", "Xdpp"});
  BatchOptions options = sensitive(1e-10);
  options.channels = {Channel::delta, Channel::speed};
  options.plants = {1};
  const Trajectory dual = play_one(grid, options, job);
  test::ReducedSystem system(grid, job.event, job.seeds);
  test::CvodesSensitivities cvodes(system, job.seeds);
  const auto columns = cvodes.columns(1, 2, dual.samples, dual.rate);
  for (std::size_t i = 0; i < job.seeds.size(); ++i)
    for (int state = 0; state < 2; ++state) {
      const double worst =
          worst_column(dual, static_cast<int>(i), columns[i][static_cast<std::size_t>(state)], state);
      RecordProperty("worst_" + std::to_string(i) + "_" + std::to_string(state),
                     testing::PrintToString(worst));
      EXPECT_LT(worst, 1e-5) << "seed " << i << " state " << state;  // required limit
    }
}

}  // namespace
}  // namespace swingbank::sim::batch
