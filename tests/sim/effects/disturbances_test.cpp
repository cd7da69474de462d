// Disturbances: their time series against hand calculations, and plant responses against closed forms.
#include <complex>
#include <numbers>

#include "sim/batch/batch.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::effects {
namespace {

using Values = std::vector<double>;

/// Signals after the evaluation of a disturbance at time t; Tm is 0.8 before it.
Signals<double> at(const char* name, const Values& p, double t) {
  const Effect& e = *library::compiled().find(name);
  Values c(static_cast<std::size_t>(e.coefficients));
  const auto& ops = e.get<double>();
  ops.prepare(p.data(), Conventions::psse(), c.data());
  Signals<double> s;
  s.Tm = 0.8;
  s.t = t;
  ops.control.evaluate(nullptr, c.data(), nullptr, s, nullptr);
  return s;
}

TEST(Disturbances, StepsLastBetweenTheirSwitchingTimes) {
  for (const auto& [t, value] :
       {std::pair{1.9999, 0.0}, {2.0, 0.03}, {2.9999, 0.03}, {3.0, 0.0}, {-1.0, 0.0}}) {
    EXPECT_EQ(at("VREFSTEP", {0.03, 2.0, 3.0}, t).dVref, value) << t;
    EXPECT_EQ(at("PREFSTEP", {0.03, 2.0, 3.0}, t).dPref, value) << t;
  }
}

TEST(Disturbances, RampsAreLinearAndKeepTheirFinalValue) {
  for (const auto& [t, value] : {std::pair{1.9, 0.0}, {2.0, 0.0}, {3.0, 0.01}, {4.0, 0.02}, {9.0, 0.02}}) {
    EXPECT_DOUBLE_EQ(at("VREFRAMP", {0.02, 2.0, 2.0}, t).dVref, value) << t;
    EXPECT_DOUBLE_EQ(at("PREFRAMP", {0.02, 2.0, 2.0}, t).dPref, value) << t;
  }
  EXPECT_EQ(at("PREFRAMP", {0.02, 2.0, 0.0}, 1.999).dPref, 0.0);
  EXPECT_EQ(at("PREFRAMP", {0.02, 2.0, 0.0}, 2.0).dPref, 0.02);  // duration 0: a step
}

TEST(Disturbances, AgcMovesAddUp) {
  const Values p = {1.0, 4.0, 2.0, 0.1, -0.05, 0.0, 0.0, 0.0, 0.2};
  for (const auto& [t, value] : {std::pair{0.999, 0.0},
                                 {2.0, 0.05},
                                 {3.0, 0.1},
                                 {4.9, 0.1},
                                 {6.0, 0.075},
                                 {7.0, 0.05},
                                 {21.0, 0.05},
                                 {22.0, 0.15},
                                 {100.0, 0.25}})
    EXPECT_NEAR(at("AGCMOVES", p, t).dPref, value, 1e-15) << t;  // sums of six numbers
}

TEST(Disturbances, FastValvingClosesWaitsAndReopens) {
  const Values p = {0.5, 1.0, 0.2, 0.3, 2.0};
  for (const auto& [t, value] :
       {std::pair{0.99, 0.8}, {1.1, 0.6}, {1.2, 0.4}, {1.5, 0.4}, {2.5, 0.6}, {3.5, 0.8}, {9.0, 0.8}})
    EXPECT_NEAR(at("FASTVALVE", p, t).Tm, value, 1e-14) << t;
}

TEST(Disturbances, ForcedOscillationIsASine) {
  const Values p = {0.1, 0.5, std::numbers::pi / 6, 1.0, 5.0};
  // sin(30 deg) = 1/2 at the start, a third of a period later sin(150 deg) = 1/2 again
  for (const auto& [t, value] : {std::pair{0.999, 0.8}, {1.0, 0.85}, {1.0 + 2.0 / 3.0, 0.85}, {5.0, 0.8}})
    EXPECT_NEAR(at("FORCEDOSC", p, t).Tm, value, 1e-14) << t;
}

TEST(Disturbances, EveryStepAndKinkIsListed) {
  const auto switching_times = [](const char* name, const Values& p) {
    return library::compiled().find(name)->switching_times(nullptr, p.data());
  };
  EXPECT_EQ(switching_times("VREFSTEP", {0.0, 2.0, 3.0}), (Values{2.0, 3.0}));
  EXPECT_EQ(switching_times("PREFRAMP", {0.0, 2.0, 3.0}), (Values{2.0, 5.0}));
  EXPECT_EQ(switching_times("FORCEDOSC", {0.0, 1.0, 0.0, 2.0, 3.0}), (Values{2.0, 3.0}));
  EXPECT_EQ(switching_times("FASTVALVE", {0.0, 1.0, 0.5, 0.25, 2.0}), (Values{1.0, 1.5, 1.75, 3.75}));
  EXPECT_EQ(switching_times("AGCMOVES", {1.0, 4.0, 2.0, 0, 0, 0, 0, 0, 0}),
            (Values{1.0, 3.0, 5.0, 7.0, 9.0, 11.0, 13.0, 15.0, 17.0, 19.0, 21.0, 23.0}));
}

TEST(Disturbances, RefuseImpossibleParameters) {
  const auto count = [](const char* name, const Values& p) {
    Problems problems;
    library::compiled().find(name)->check(nullptr, p.data(), "here", problems);
    return problems.list().size();
  };
  EXPECT_EQ(count("VREFSTEP", {0.1, -1.0, -2.0}), 2u);
  EXPECT_EQ(count("PREFRAMP", {0.1, -1.0, -2.0}), 2u);
  EXPECT_EQ(count("FORCEDOSC", {0.1, 0.0, 0.0, -1.0, -2.0}), 3u);
  EXPECT_EQ(count("FASTVALVE", {0.5, -1.0, -1.0, -1.0, -1.0}), 4u);
  EXPECT_EQ(count("AGCMOVES", {-1.0, 0.0, -1.0, 0, 0, 0, 0, 0, 0}), 3u);
}

/// Two infinite buses; the second has an exciter and a governor. Speed and terminal voltage are constant, so
/// their responses have a closed form.
grid::Grid two_infinite_buses() {
  grid::Grid grid = test::two_machine_grid(Conventions::psse());
  plant::Plant& plant = grid.plants[1];
  plant.machine = {library::compiled().find("GENCLS"), {0.0, 0.0, 0.0, 1e-6}};
  plant.controls = {{library::compiled().find("SEXS"), {1.0, 0.0, 20.0, 0.5, -10.0, 10.0}},
                    {library::compiled().find("TGOV1"), {0.05, 0.4, 2.0, -2.0, 0.0, 0.0, 0.0, 0.0}}};
  return grid;
}
void add(plant::Plant& plant, const char* name, Values p) {
  plant.controls.push_back({library::compiled().find(name), std::move(p)});
  std::ranges::stable_sort(plant.controls, {}, [](const plant::Block& b) { return b.effect->slot; });
}
reference::ReferenceRun reference(const grid::Grid& grid, double t_end = 8.0) {
  reference::ReferenceOptions options;
  options.t_end = t_end;
  options.plants = {1};
  return reference::run_reference(grid, {}, options);
}
Trajectory batch_run(const grid::Grid& grid, double t_end = 8.0) {
  batch::BatchOptions options;
  options.t_end = t_end;
  options.plants = {1};
  batch::Batch batch(grid, options);
  Trajectory run;
  bool given = false;
  batch.run([&](batch::Job&) { return !std::exchange(given, true); },
            [&](const batch::Job&, const Trajectory& t) { run = t; });
  return run;
}
/// Largest difference between a channel's deviation from its first value and `expected(t)`.
template <class F>
double worst(const Trajectory& run, Channel channel, const F& expected) {
  double most = 0.0;
  const double* row = run.at(0, static_cast<int>(channel));
  for (int k = 0; k < run.samples; ++k)
    most = std::max(most, std::abs(row[k] - row[0] - expected(k / run.rate)));
  return most;
}
double lagged(double tau, double T) { return tau <= 0.0 ? 0.0 : -std::expm1(-tau / T); }
double lagged_ramp(double tau, double T) { return tau <= 0.0 ? 0.0 : tau - T * lagged(tau, T); }

// Tolerances per step: IDA 1e-8, the SIMD batch 1e-6. Earlier errors decay exponentially. The infinite bus's
// impedance of 1e-6 pu amplifies the rounding of its voltage, which limits the tolerance.
constexpr double kReferenceTolerance = 1e-6, kBatchTolerance = 1e-5;

TEST(Disturbances, VrefStepIsLaggedByTheExciter) {
  grid::Grid grid = two_infinite_buses();
  add(grid.plants[1], "VREFSTEP", {0.01, 2.0, 5.0});
  const auto expected = [](double t) { return 20.0 * 0.01 * (lagged(t - 2.0, 0.5) - lagged(t - 5.0, 0.5)); };
  EXPECT_LE(worst(reference(grid), Channel::Efd, expected), kReferenceTolerance);
  EXPECT_LE(worst(batch_run(grid), Channel::Efd, expected), kBatchTolerance);
}

TEST(Disturbances, PrefRampIsLaggedByTheGovernor) {
  grid::Grid grid = two_infinite_buses();
  add(grid.plants[1], "PREFRAMP", {0.1, 1.0, 3.0});
  const auto expected = [](double t) {
    return 0.1 / 3.0 * (lagged_ramp(t - 1.0, 0.4) - lagged_ramp(t - 4.0, 0.4));
  };
  EXPECT_LE(worst(reference(grid), Channel::Tm, expected), kReferenceTolerance);
  EXPECT_LE(worst(batch_run(grid), Channel::Tm, expected), kBatchTolerance);
}

TEST(Disturbances, AgcMovesAreLaggedByTheGovernor) {
  grid::Grid grid = two_infinite_buses();
  add(grid.plants[1], "AGCMOVES", {1.0, 2.0, 1.0, 0.1, -0.05, 0.02, 0.0, 0.0, 0.0});
  const auto expected = [](double t) {
    double sum = 0.0;
    for (const auto& [start, move] : {std::pair{1.0, 0.1}, {3.0, -0.05}, {5.0, 0.02}})
      sum += move * (lagged_ramp(t - start, 0.4) - lagged_ramp(t - start - 1.0, 0.4));
    return sum;
  };
  EXPECT_LE(worst(reference(grid), Channel::Tm, expected), kReferenceTolerance);
  EXPECT_LE(worst(batch_run(grid), Channel::Tm, expected), kBatchTolerance);
}

TEST(Disturbances, FastValvingActsAfterTheGovernor) {
  grid::Grid grid = two_infinite_buses();
  const double before = reference(grid, 1.0).at(0, static_cast<int>(Channel::Tm))[0];
  add(grid.plants[1], "FASTVALVE", {0.4, 2.0, 0.1, 0.5, 2.0});
  const auto expected = [&](double t) {
    const double shut = std::clamp((t - 2.0) / 0.1, 0.0, 1.0) - std::clamp((t - 2.6) / 2.0, 0.0, 1.0);
    return -0.4 * before * shut;
  };
  // No state lies in between. A sample at a kink is the torque 1e-9 s before it, and the torque changes by up
  // to 4 pu/s.
  EXPECT_LE(worst(reference(grid), Channel::Tm, expected), 1e-8);
  EXPECT_LE(worst(batch_run(grid), Channel::Tm, expected), 1e-8);
}

/// A classical machine swings linearly for a small torque: speed = A s / (2 H s^2 + D s + w0 Ks).
TEST(Disturbances, ForcedOscillationMatchesTheLinearModel) {
  grid::Grid grid = test::two_machine_grid(Conventions::andes());
  plant::Plant& plant = grid.plants[1];
  constexpr double H = 3.0, D = 20.0, A = 1e-4, f = 0.7, start = 1.0, x = 0.25;
  plant.machine = {library::compiled().find("GENCLS"), {H, D, 0.0, x}};
  const auto operating = plant::operating_point(plant, grid.flow.voltage[2], 100.0, grid.conventions);
  add(plant, "FORCEDOSC", {A, f, 0.0, start, 1e5});
  const reference::ReferenceRun run = reference(grid, 15.0);
  const double w = 2.0 * std::numbers::pi * f, w0 = 2.0 * std::numbers::pi * 60.0;
  // Synchronising torque from a second run with a permanent torque change: Ks = change of torque / of angle.
  grid::Grid shifted = grid;
  shifted.plants[1].controls = {
      {library::compiled().find("FORCEDOSC"), {A, 1e-3, std::numbers::pi / 2, 1.0, 1e5}}};
  const reference::ReferenceRun still = reference(shifted, 15.0);
  const double* angle = still.at(0, static_cast<int>(Channel::delta));
  const int end = still.samples - 1;
  const double torque = A * std::cos(2.0 * std::numbers::pi * 1e-3 * (end / still.rate - start));
  const double Ks = torque / (angle[end] - angle[0]);
  const std::complex<double> s(0.0, w), gain = s / (2.0 * H * s * s + D * s + w0 * Ks);
  const double* speed = run.at(0, static_cast<int>(Channel::speed));
  double most = 0.0, largest = 0.0;
  for (int k = 0; k < run.samples; ++k) {
    const double t = k / run.rate;
    if (t < 10.0) continue;  // the free swing decays with D/4H = 1.7 per second to 3e-7
    const double expected = A * (gain * std::exp(s * (t - start))).imag();
    most = std::max(most, std::abs(speed[k] - expected));
    largest = std::max(largest, std::abs(expected));
  }
  // The nonlinearity of a swing of 1e-4 pu is of second order. The angle from which Ks is computed still
  // changes by 0.1 %, because its torque is a slow sine (1 mHz).
  EXPECT_LE(most, 5e-3 * largest);
  EXPECT_GT(largest, 1e-7);
  EXPECT_GT(operating.Tm, 0.0);
}

TEST(Disturbances, HaveNoEffectBeforeTheirFirstSwitchingTime) {
  const std::vector<std::pair<const char*, std::pair<Values, Values>>> disturbances = {
      {"VREFSTEP", {{0.05, 2.0, 3.0}, {0.0, 2.0, 3.0}}},
      {"VREFRAMP", {{0.05, 2.0, 1.0}, {0.0, 2.0, 1.0}}},
      {"PREFSTEP", {{0.05, 2.0, 3.0}, {0.0, 2.0, 3.0}}},
      {"PREFRAMP", {{0.05, 2.0, 1.0}, {0.0, 2.0, 1.0}}},
      {"AGCMOVES", {{2.0, 4.0, 2.0, .1, 0, 0, 0, 0, 0}, {2.0, 4.0, 2.0, 0, 0, 0, 0, 0, 0}}},
      {"FASTVALVE", {{0.5, 2.0, 0.1, 0.2, 1.0}, {0.0, 2.0, 0.1, 0.2, 1.0}}},
      {"FORCEDOSC", {{0.1, 0.5, 1.0, 2.0, 1e5}, {0.0, 0.5, 1.0, 2.0, 1e5}}}};
  for (const auto& [name, values] : disturbances) {
    grid::Grid grid = test::two_machine_grid(Conventions::psse());
    grid.plants[1].controls = {
        {library::compiled().find("SEXS"), library::compiled().find("SEXS")->default_parameters()},
        {library::compiled().find("TGOV1"), library::compiled().find("TGOV1")->default_parameters()}};
    grid::Grid silent = grid;
    add(grid.plants[1], name, values.first);
    add(silent.plants[1], name, values.second);
    const network::Event event{{{1, 1.0, 1.05, {0.0, 0.1}}}, {}};  // a fault, so that the plant moves
    reference::ReferenceOptions options;
    options.t_end = 4.0;
    const reference::ReferenceRun a = reference::run_reference(grid, event, options),
                                  b = reference::run_reference(silent, event, options);
    double later = 0.0;
    for (int row = 0; row < a.rows(); ++row)
      for (int k = 0; k < a.samples; ++k) {
        if (k <= 240)
          EXPECT_EQ(a.row(row)[k], b.row(row)[k]) << name << " at " << k / a.rate << " s";
        else
          later = std::max(later, std::abs(a.row(row)[k] - b.row(row)[k]));
      }
    EXPECT_GT(later, 1e-3) << name;
  }
}

}  // namespace
}  // namespace swingbank::sim::effects
