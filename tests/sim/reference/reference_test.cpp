#include "sim/reference/reference.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "sim/reference/detail/system.hpp"
#include "tests/sim/network/branch_index.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::reference {
namespace {

using test::configured_grid;
using test::largest_difference;
using test::two_machine_grid;

network::Event fault(const grid::Grid& grid, int bus, double on, double off, Complex z = {}) {
  network::Event event;
  event.faults.push_back({grid.network.bus_index(bus), on, off, z});
  return event;
}

network::Event trip(const grid::Grid& grid, int from, int to, const std::string& circuit, double open,
                    std::optional<double> close = {}) {
  network::Event event;
  event.trips.push_back({network::branch_index(grid.network, from, to, circuit), open, close});
  return event;
}

/// Largest deviation of any channel from its first value.
double drift(const Trajectory& run) {
  double worst = 0.0;
  for (int row = 0; row < run.rows(); ++row) {
    const double* v = run.row(row);
    for (int k = 0; k < run.samples; ++k) worst = std::max(worst, std::abs(v[k] - v[0]));
  }
  return worst;
}

TEST(Reference, IsSteadyWithoutAFault) {
  for (const char* name : {"ieee39_genrou", "ieee39_gencls", "ieee14_genrou"}) {
    const grid::Grid grid = configured_grid(name, Conventions::psse());
    const ReferenceRun run = run_reference(grid, {}, {});
    EXPECT_EQ(run.outcome, Outcome::stable);
    EXPECT_EQ(run.samples, 1801);
    EXPECT_LT(drift(run), 1e-9) << name;  // required: drift < 1e-9 over 15 s
  }
}

TEST(Reference, JacobianEqualsCentralDifferences) {
  const grid::Grid grid = configured_grid("ieee14_genrou", Conventions::psse());
  const ReferencePlants plants(grid);
  network::Topology topology;
  topology.faults = {
      {grid.network.bus_index(2), Complex()}};  // a machine's own bus: its network rows are V = 0
  const ReferenceSystem system(grid, plants, {0.0, topology, {}}, 1.0);
  const int n = system.size();
  std::vector<double> y(n, 0.0), yp(n, 0.0), low(n), high(n);
  for (const auto& unit : plants.units())
    std::copy(unit.operating.x.begin(), unit.operating.x.end(), y.begin() + unit.first);
  std::mt19937_64 random(1);  // not in steady state, so that no term is zero by chance
  for (auto& value : y) value += 1e-3 * (static_cast<double>(random() % 2001) / 1000.0 - 1.0);
  system.solve_voltages(0.0, y.data());
  const double a = 7.0;
  Eigen::SparseMatrix<double> jacobian = system.pattern();
  system.jacobian(0.0, a, y.data(), jacobian.valuePtr());
  for (int col = 0; col < n; ++col) {
    const double h = 1e-5, keep = y[col], keep_p = yp[col];
    y[col] = keep + h;
    yp[col] = keep_p + a * h;
    system.residual(0.0, y.data(), yp.data(), high.data());
    y[col] = keep - h;
    yp[col] = keep_p - a * h;
    system.residual(0.0, y.data(), yp.data(), low.data());
    y[col] = keep;
    yp[col] = keep_p;
    for (int row = 0; row < n; ++row) {
      const double quotient = (high[row] - low[row]) / (2 * h), value = jacobian.coeff(row, col);
      // h^2 of the central difference on entries up to 400, relative to the entry's size
      EXPECT_NEAR(value, quotient, 1e-6 * std::max(1.0, std::abs(value)))
          << "row " << row << " column " << col;
    }
  }
}

TEST(Reference, SolvedVoltagesSatisfyTheEquations) {
  const grid::Grid grid = configured_grid("ieee39_genrou", Conventions::psse());
  const ReferencePlants plants(grid);
  for (const Complex z : {Complex(), Complex(0, 1e-6), Complex(0.01, 0.02)}) {
    network::Topology topology;
    topology.faults = {{grid.network.bus_index(16), z}};
    const ReferenceSystem system(grid, plants, {0.0, topology, {}}, 1.0);
    std::vector<double> y(system.size()), yp(system.size()), f(system.size());
    for (const auto& unit : plants.units())
      std::copy(unit.operating.x.begin(), unit.operating.x.end(), y.begin() + unit.first);
    system.solve_voltages(0.0, y.data());
    system.derivatives(0.0, y.data(), yp.data());
    system.residual(0.0, y.data(), yp.data(), f.data());
    // rounding of currents of 1e2 pu through admittances of 1e6 pu: a few times 1e6 * 1e-16
    for (double value : f) EXPECT_LT(std::abs(value), 1e-8);
  }
}

TEST(Reference, BoltedFaultIsTheLimitOfFaultsThroughAnImpedance) {
  const grid::Grid grid = two_machine_grid(Conventions::psse());
  ReferenceOptions options;
  options.t_end = 3.0;
  const ReferenceRun bolted = run_reference(grid, fault(grid, 2, 0.5, 0.6), options);
  double last = 1e300;
  for (double x : {1e-2, 1e-3, 1e-4, 1e-5}) {
    const ReferenceRun run = run_reference(grid, fault(grid, 2, 0.5, 0.6, {0.0, x}), options);
    // Only continuous channels are compared: with V = 0 the voltage angle keeps its value, behind an
    // impedance it does not.
    double worst = 0.0;
    for (int p = 0; p < 2; ++p)
      for (int c : {0, 1, 2, 3, 4})
        for (int k = 0; k < run.samples; ++k)
          worst = std::max(worst, std::abs(run.at(p, c)[k] - bolted.at(p, c)[k]));
    EXPECT_LT(worst, last / 5) << "x = "
                               << x;  // first order in x: a tenth each time, with a margin for curvature
    last = worst;
  }
  EXPECT_LT(last, 5e-3);  // fault currents of some 10 pu through 1e-5 pu, seen through 1/X'' on the small
                          // infinite impedance
}

TEST(Reference, ThetaIsKeptDuringABoltedTerminalFault) {
  const grid::Grid grid = two_machine_grid(Conventions::psse());
  ReferenceOptions options;
  options.t_end = 1.0;
  options.channels = {Channel::V, Channel::theta, Channel::P};
  options.buses = {1, 2};
  const ReferenceRun run = run_reference(grid, fault(grid, 3, 0.5, 0.6), options);
  for (int k = 61; k <= 72; ++k) {
    EXPECT_EQ(run.at(1, 0)[k], 0.0);
    EXPECT_EQ(run.at(1, 1)[k], run.at(1, 1)[60]);
    EXPECT_EQ(run.at(1, 2)[k], 0.0);
    EXPECT_EQ(run.bus_v[run.samples + k], 0.0);
  }
  EXPECT_GT(run.at(1, 0)[60], 0.9);  // sample 60 is the switching time: the value before
  EXPECT_GT(run.at(1, 0)[73], 0.5);
  EXPECT_EQ(run.bus_theta[run.samples + 30], run.at(1, 1)[30]);
}

TEST(Reference, SwitchingTimeHasTwoLimits) {
  const grid::Grid grid = two_machine_grid(Conventions::psse());
  ReferenceOptions options;
  options.t_end = 1.0;
  options.channels = {Channel::V, Channel::delta};
  const network::Event event = fault(grid, 3, 0.5, 0.6);
  const ReferenceRun before = run_reference(grid, event, options);
  options.after_switching = true;
  const ReferenceRun after = run_reference(grid, event, options);
  for (int k = 0; k < before.samples; ++k) {
    if (k == 60) {
      EXPECT_GT(before.at(1, 0)[k], 0.9);
      EXPECT_EQ(after.at(1, 0)[k], 0.0);
    } else if (k == 72) {
      EXPECT_EQ(before.at(1, 0)[k], 0.0);
      EXPECT_GT(after.at(1, 0)[k], 0.5);
    } else {
      EXPECT_NEAR(before.at(1, 0)[k], after.at(1, 0)[k], 1e-7);  // the same integration with other stop times
    }
    EXPECT_NEAR(before.at(1, 1)[k], after.at(1, 1)[k], 1e-7);  // states are continuous
  }
}

TEST(Reference, AnEventAtTheStartLeavesTheOperatingPointAsFirstSample) {
  const grid::Grid grid = two_machine_grid(Conventions::psse());
  ReferenceOptions options;
  options.t_end = 0.5;
  options.channels = {Channel::V};
  const network::Event event = fault(grid, 3, 0.0, 0.1);
  EXPECT_NEAR(run_reference(grid, event, options).at(1, 0)[0], 1.01,
              1e-9);  // the machine's voltage set point
  options.after_switching = true;
  EXPECT_EQ(run_reference(grid, event, options).at(1, 0)[0], 0.0);
}

TEST(Reference, ReclosingRestoresTheOperatingPoint) {
  const grid::Grid grid = two_machine_grid(Conventions::psse());
  ReferenceOptions options;
  options.t_end = 60.0;  // the swing decays
  options.rate = 10.0;
  const ReferenceRun reclosed = run_reference(grid, trip(grid, 2, 3, "1", 1.0, 1.4), options);
  const ReferenceRun open = run_reference(grid, trip(grid, 2, 3, "1", 1.0), options);
  ASSERT_EQ(reclosed.outcome, Outcome::stable);
  const int last = reclosed.samples - 1;
  for (int c = 0; c < kChannelCount; ++c)
    // remainder of a swing of 0.1 rad after 58 s of damping, and of a field transient with T'do of some
    // seconds
    EXPECT_NEAR(reclosed.at(1, c)[last], reclosed.at(1, c)[0], 2e-4) << kChannels[c].name;
  EXPECT_GT(std::abs(open.at(1, 0)[last] - open.at(1, 0)[0]), 1e-2)
      << "an open line moves the operating point";
}

TEST(Reference, InfiniteBusKeepsItsVoltage) {
  const grid::Grid grid = two_machine_grid(Conventions::psse());
  const ReferenceRun run = run_reference(grid, fault(grid, 2, 0.5, 0.6), {});
  for (int k = 0; k < run.samples; ++k) {
    EXPECT_EQ(run.at(0, 0)[k], run.at(0, 0)[0]);
    EXPECT_EQ(run.at(0, 1)[k], 0.0);
  }
  EXPECT_GT(run.largest_spread, 0.1);  // although the machine swings
}

TEST(Reference, StatorResistanceIsInTheBalance) {
  const double ra = 0.02;
  const grid::Grid grid = two_machine_grid(Conventions::psse(), ra);
  ReferenceOptions options;
  options.t_end = 5.0;
  const ReferenceRun still = run_reference(grid, {}, options);
  EXPECT_LT(drift(still), 1e-9);
  const double p = still.at(1, 2)[0], q = still.at(1, 3)[0], v = still.at(1, 4)[0];
  // Torque of the shaft = terminal power + Ra I^2; both sides are computed to rounding.
  EXPECT_NEAR(still.at(1, 8)[0], p + ra * (p * p + q * q) / (v * v), 1e-12);
  EXPECT_NEAR(p, 0.9 / 1.5, 1e-10);  // dispatch of 90 MW on 150 MVA; the power flow solves to 1e-12 pu
}

TEST(Reference, ConvergesWithItsTolerance) {
  const grid::Grid grid = configured_grid("ieee39_genrou", Conventions::psse());
  const network::Event event = fault(grid, 16, 2.0, 2.1);
  ReferenceOptions options;
  const ReferenceRun usual = run_reference(grid, event, options);
  options.rtol = 1e-10;
  options.atol = 1e-12;
  const ReferenceRun fine = run_reference(grid, event, options);
  ASSERT_EQ(usual.outcome, Outcome::stable);
  // A hundredth of the limit of the SIMD kernel (1e-4), so that the reference's error is negligible there.
  EXPECT_LT(largest_difference(usual, fine), 1e-6);
}

TEST(Reference, ALossOfSynchronismEndsTheRun) {
  const grid::Grid grid = configured_grid("ieee39_genrou", Conventions::psse());
  const ReferenceRun run = run_reference(grid, fault(grid, 16, 1.0, 2.0), {});
  ASSERT_EQ(run.outcome, Outcome::lost_synchronism);
  EXPECT_EQ(run.lost_by.substr(0, 7), "angle: ") << run.lost_by;
  EXPECT_NE(run.lost_by.find(" against "), std::string::npos) << run.lost_by;
  EXPECT_GT(run.stopped_at, 1.0);
  EXPECT_LT(run.stopped_at, 15.0);
  EXPECT_GE(run.largest_spread, 3.14159265358979);
  const int last = static_cast<int>(std::lround(run.stopped_at * run.rate));
  for (int c = 0; c < kChannelCount; ++c)
    for (int k = last; k < run.samples; ++k) EXPECT_EQ(run.at(0, c)[k], run.at(0, c)[last]);
  for (double v : run.values) ASSERT_TRUE(std::isfinite(v));
}

TEST(Reference, RefusesATripThatCutsOffABus) {
  grid::Grid grid = two_machine_grid(Conventions::psse());
  grid.network.branches.erase(grid.network.branches.begin() + 1, grid.network.branches.end());
  grid.plants.pop_back();  // bus 2 is connected to the infinite bus by one line; bus 3 is isolated
  try {
    run_reference(grid, {}, {});
    FAIL() << "a bus without connection was accepted";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("islanded converters: bus 3"));
  }
}

}  // namespace
}  // namespace swingbank::sim::reference
