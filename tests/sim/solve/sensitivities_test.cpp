// Forward sensitivities of the lanes kernel against two other ways: central differences of the plain kernel,
// and SUNDIALS CVODES with its own difference quotients on the same reduced equations.
#include <cvodes/cvodes.h>
#include <gtest/gtest.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <memory>

#include "../reference_support.hpp"
#include "sim/solve/batch.hpp"
#include "sim/solve/internal_network.hpp"
#include "sim/solve/plant_equations.hpp"

namespace swingbank::sim {
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
Trajectory play(const Grid& grid, const BatchOptions& options, const Job& job) {
  Batch batch(grid, options);
  Trajectory result;
  bool given = false;
  batch.run([&](Job& next) { return !std::exchange(given, true) && (next = job, true); },
            [&](const Job&, const Trajectory& t) { result = t; });
  return result;
}
std::vector<Seed> seeds(const Grid& grid, int plant, const std::vector<const char*>& names) {
  std::vector<Seed> list;
  const Block& machine = grid.plants[static_cast<std::size_t>(plant)].machine;
  for (const char* name : names) {
    const int index = machine.effect->parameter_index(name);
    list.push_back({plant, 0, index, std::max(0.1, std::abs(machine.p[static_cast<std::size_t>(index)]))});
  }
  return list;
}
Event fault(const Grid& grid, int bus) {
  Event event;
  event.faults.push_back({grid.network.bus_index(bus), 0.2, 0.3, {}});
  return event;
}

/// Largest difference of a column from `other`, over the column's largest value.
double worst_column(const Trajectory& t, int direction, const std::vector<double>& other, int row) {
  const auto channels = static_cast<int>(t.channels.size());
  const double* own = t.slope(direction, row / channels, row % channels);
  double largest = 0.0, worst = 0.0;
  for (int k = 0; k < t.samples; ++k)
    largest = std::max(largest, std::abs(other[static_cast<std::size_t>(k)]));
  for (int k = 0; k < t.samples; ++k)
    worst = std::max(worst, std::abs(own[k] - other[static_cast<std::size_t>(k)]));
  return largest > 0.0 ? worst / largest : worst;
}

TEST(Sensitivities, EqualCentralDifferences) {
  const Grid grid = configured_grid("ieee39_genrou", Conventions::psse());
  constexpr int plant = 4;
  Job job;
  job.event = fault(grid, 16);
  job.seeds = seeds(grid, plant, {"H", "D", "Xd", "Xdp", "Xdpp", "Tdop", "S10", "Ra"});
  BatchOptions options = sensitive(1e-9);
  options.plants = {plant, 0};
  const Trajectory dual = play(grid, options, job);
  ASSERT_EQ(dual.outcome, Outcome::stable);
  options.sensitivities = false;
  options.tolerance = 1e-11;  // so that its own error, divided by the step below, stays beneath 1e-6
  for (std::size_t d = 0; d < job.seeds.size(); ++d) {
    const Seed& seed = job.seeds[d];
    const double h = 1e-4 * seed.scale;
    Trajectory side[2];
    for (int s = 0; s < 2; ++s) {
      Job moved;
      moved.event = job.event;
      auto p = grid.plants[plant].machine.p;
      p[static_cast<std::size_t>(seed.parameter)] += s == 0 ? h : -h;
      moved.machine_parameters.emplace_back(plant, p);
      side[s] = play(grid, options, moved);
    }
    const bool at_edge =
        grid.plants[plant].machine.p[static_cast<std::size_t>(seed.parameter)] == 0.0 &&
        grid.plants[plant].machine.effect->parameters[static_cast<std::size_t>(seed.parameter)].name == "S10";
    if (at_edge) continue;  // no saturation in this file: there is no derivative across its onset
    for (int row = 0; row < dual.rows(); ++row) {
      std::vector<double> quotient(static_cast<std::size_t>(dual.samples));
      for (int k = 0; k < dual.samples; ++k)
        quotient[static_cast<std::size_t>(k)] =
            (side[0].row(row)[k] - side[1].row(row)[k]) / (2 * h) * seed.scale;
      // the limit; the quotient's third-order term is 1e-8 relative, the integrators' errors 1e-7
      EXPECT_LT(worst_column(dual, static_cast<int>(d), quotient, row), 1e-5)
          << "row " << row << " by "
          << grid.plants[plant].machine.effect->parameters[static_cast<std::size_t>(seed.parameter)].name;
    }
  }
}

TEST(Sensitivities, ValuesAreThoseOfThePlainKernel) {
  const Grid grid = configured_grid("ieee39_genrou", Conventions::psse());
  Job job;
  job.event = fault(grid, 4);
  job.seeds = seeds(grid, 2, {"H", "Xd"});
  BatchOptions options = sensitive(1e-9);
  const Trajectory dual = play(grid, options, job);
  options.sensitivities = false;
  const Trajectory plain = play(grid, options, job);
  for (int row = 0; row < plain.rows(); ++row)
    for (int k = 0; k < plain.samples; ++k)  // other steps, each true to 1e-9 per step
      EXPECT_NEAR(dual.row(row)[k], plain.row(row)[k], 1e-6);
}

/// The reduced equations of a grid after a switching at t = 0, as CVODES wants them: parameters in p.
struct Reduced {
  Grid grid;
  Event event;
  int plant;
  std::vector<Seed> seeds;
  std::vector<double> p;  ///< seeded values
  Grid moved;
  std::vector<Operating> at;
  InternalMatrix matrix;
  std::vector<double> used;  ///< the parameters `at` was made with

  void update() {
    if (used == p) return;
    used = p;
    moved = grid;
    for (std::size_t i = 0; i < seeds.size(); ++i)
      moved.plants[static_cast<std::size_t>(plant)].machine.p[static_cast<std::size_t>(seeds[i].parameter)] =
          p[i];
    at.clear();
    std::vector<double> r, x;
    for (const Plant& each : moved.plants) {
      at.push_back(operating_point(each, moved.flow.voltage[static_cast<std::size_t>(each.bus)],
                                   moved.network.base_mva, moved.conventions));
      const double* z = PlantEquations<double>(each).impedance(at.back().c.data());
      r.push_back(z[0]);
      x.push_back(z[1]);
    }
    InternalNetwork network(moved);
    matrix = network.matrix(segments(event, moved.network).front().topology, r, x);
  }
  [[nodiscard]] std::vector<double> start() {
    update();
    std::vector<double> y;
    for (const Operating& o : at) y.insert(y.end(), o.x.begin(), o.x.end());
    return y;
  }
  void derivative(const double* y, double* dy) {
    update();
    const std::size_t n = moved.plants.size();
    std::vector<double> er(n), ei(n);
    std::vector<std::vector<double>> m(n);
    std::vector<PlantEquations<double>> equations;
    std::vector<std::size_t> first;
    std::size_t states = 0;
    for (std::size_t i = 0; i < n; ++i) {
      equations.emplace_back(moved.plants[i]);
      m[i].resize(static_cast<std::size_t>(equations[i].scratch()));
      first.push_back(states);
      equations[i].emf(at[i].c.data(), y + states, m[i].data(), er[i], ei[i]);
      states += static_cast<std::size_t>(equations[i].states());
    }
    for (std::size_t i = 0; i < n; ++i) {
      Signals<double> s;
      for (std::size_t j = 0; j < n; ++j) {
        s.Ir += matrix.g[i * n + j] * er[j] - matrix.b[i * n + j] * ei[j];
        s.Ii += matrix.g[i * n + j] * ei[j] + matrix.b[i * n + j] * er[j];
      }
      s.Efd = at[i].Efd;
      s.Tm = at[i].Tm;
      equations[i].machine_derivative(at[i].c.data(), y + first[i], m[i].data(), s, dy + first[i]);
    }
  }
};
int rhs(realtype, N_Vector y, N_Vector dy, void* user) {
  static_cast<Reduced*>(user)->derivative(N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
  return 0;
}

TEST(Sensitivities, EqualThoseOfCvodes) {
  Reduced system{configured_grid("ieee14_genrou", Conventions::psse()), {}, 1, {}, {}, {}, {}, {}, {}};
  system.event.trips.push_back(
      {system.grid.network.branch_index(2, 3, "1"), 0.0, {}});  // nothing switches later
  ASSERT_GE(system.event.trips[0].branch, 0);
  system.seeds = seeds(system.grid, 1, {"H", "Tdop", "Xdp", "Xdpp"});
  for (const Seed& seed : system.seeds)
    system.p.push_back(system.grid.plants[1].machine.p[static_cast<std::size_t>(seed.parameter)]);
  const auto count = static_cast<int>(system.seeds.size());

  Job job;
  job.event = system.event;
  job.seeds = system.seeds;
  BatchOptions options = sensitive(1e-10);
  options.channels = {Channel::delta, Channel::speed};
  options.plants = {1};
  const Trajectory dual = play(system.grid, options, job);

  SUNContext context = nullptr;
  ASSERT_EQ(SUNContext_Create(nullptr, &context), 0);
  const auto start = system.start();
  const auto size = static_cast<sunindextype>(start.size());
  N_Vector y = N_VNew_Serial(size, context);
  std::copy(start.begin(), start.end(), N_VGetArrayPointer(y));
  N_Vector* slopes = N_VCloneVectorArray(count, y);
  const auto nominal = system.p;
  for (int i = 0; i < count; ++i) {  // of the operating point, by central differences
    const double h = 1e-5 * nominal[static_cast<std::size_t>(i)];
    system.p[static_cast<std::size_t>(i)] += h;
    const auto up = system.start();
    system.p[static_cast<std::size_t>(i)] -= 2 * h;
    const auto down = system.start();
    system.p = nominal;
    for (sunindextype k = 0; k < size; ++k)
      N_VGetArrayPointer(slopes[i])[k] =
          (up[static_cast<std::size_t>(k)] - down[static_cast<std::size_t>(k)]) / (2 * h);
  }
  void* cvode = CVodeCreate(CV_BDF, context);
  SUNMatrix matrix = SUNDenseMatrix(size, size, context);
  SUNLinearSolver solver = SUNLinSol_Dense(y, matrix, context);
  ASSERT_EQ(CVodeInit(cvode, rhs, 0.0, y), 0);
  ASSERT_EQ(CVodeSStolerances(cvode, 1e-9, 1e-11), 0);
  ASSERT_EQ(CVodeSetUserData(cvode, &system), 0);
  ASSERT_EQ(CVodeSetLinearSolver(cvode, solver, matrix), 0);
  ASSERT_EQ(CVodeSetMaxNumSteps(cvode, 100000), 0);
  ASSERT_EQ(CVodeSensInit1(cvode, count, CV_SIMULTANEOUS, nullptr, slopes), 0);
  auto scales = nominal;
  ASSERT_EQ(CVodeSetSensParams(cvode, system.p.data(), scales.data(), nullptr), 0);
  ASSERT_EQ(CVodeSensEEtolerances(cvode), 0);
  ASSERT_EQ(CVodeSetSensErrCon(cvode, 1), 0);
  std::vector<std::vector<double>> column(static_cast<std::size_t>(2 * count));
  std::size_t first = 0;
  first += static_cast<std::size_t>(PlantEquations<double>(system.grid.plants[0]).states());
  for (int k = 0; k < dual.samples; ++k) {
    realtype t = 0.0;
    if (k > 0) {
      ASSERT_GE(CVode(cvode, k / options.rate, y, &t, CV_NORMAL), 0);
      ASSERT_EQ(CVodeGetSens(cvode, &t, slopes), 0);
    }
    for (int i = 0; i < count; ++i)
      for (std::size_t state = 0; state < 2; ++state)
        column[static_cast<std::size_t>(2 * i) + state].push_back(
            N_VGetArrayPointer(slopes[i])[first + state] * system.seeds[static_cast<std::size_t>(i)].scale);
  }
  for (int i = 0; i < count; ++i)
    for (int state = 0; state < 2; ++state) {
      const double worst = worst_column(dual, i, column[static_cast<std::size_t>(2 * i + state)], state);
      RecordProperty("worst_" + std::to_string(i) + "_" + std::to_string(state),
                     testing::PrintToString(worst));
      EXPECT_LT(worst, 1e-5) << "seed " << i << " state " << state;  // the limit
    }
  N_VDestroyVectorArray(slopes, count);
  N_VDestroy(y);
  CVodeFree(&cvode);
  SUNLinSolFree(solver);
  SUNMatDestroy(matrix);
  SUNContext_Free(&context);
}

}  // namespace
}  // namespace swingbank::sim
