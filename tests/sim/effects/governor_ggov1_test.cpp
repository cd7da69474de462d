// GGOV1: transfer function of the governor's path for every droop code, steady droop, each limiter's own
// response, release without wind-up, refusals.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using Complex = std::complex<double>;
const ControlBench::Changes kGgov1Values = {{"R", 0.05},    {"Tpelec", 0.5}, {"Kpgov", 8.0}, {"Kigov", 1.5},
                                            {"Kdgov", 2.0}, {"Tdgov", 0.2},  {"Tact", 0.4},  {"Kturb", 1.5},
                                            {"Wfnl", 0.2},  {"Tb", 0.6},     {"Tc", 0.1},    {"Dm", 0.2},
                                            {"Ldref", 1.1}};
Complex pid(Complex s) { return 8.0 + 1.5 / s + s * 2.0 / (1.0 + s * 0.2); }

ControlBench bench_with(ControlBench::Changes changes, Signals<double> at = ControlBench::rated()) {
  ControlBench::Changes all = kGgov1Values;
  for (const auto& [name, value] : changes) all[name] = value;
  return ControlBench("GGOV1", all, at);
}

/// Transfer function from speed to Pm at constant electrical power, which is a separate input.
TEST(GovernorGgov1, SmallSignalsFollowTheTransferFunction) {
  for (const double code : {1.0, 0.0, -1.0, -2.0})
    for (const double flag : {0.0, 1.0}) {
      ControlBench bench = bench_with({{"Rselect", code}, {"Flag", flag}});
      ASSERT_EQ(bench.refused, "");
      EXPECT_LT(bench.largest_derivative(), 1e-12);
      const double valve = (0.8 + 0.2) / 1.5 + 0.2;  // Dm reduces the power by 0.2 pu at rated speed
      for (const double omega : {0.05, 0.5, 5.0}) {
        const Complex s(0.0, omega), actuator = 1.0 / (1.0 + s * 0.4);
        Complex stroke = -pid(s);
        if (code == -1.0) stroke /= 1.0 + 0.05 * pid(s) * actuator;
        if (code == -2.0) stroke /= 1.0 + 0.05 * pid(s);
        const Complex exact = 1.5 * (stroke * actuator + flag * valve) * lead_over_lag(0.1, 0.6, omega) - 0.2;
        const Complex h = bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega);
        EXPECT_LT(std::abs(h - exact), 1e-6 * (1.0 + std::abs(exact)))  // difference quotients with step 1e-6
            << code << " " << flag << " " << omega;
        const Complex by_power = bench.response(&Signals<double>::P, &Signals<double>::Tm, omega);
        const Complex droop =
            code == 1.0 ? -0.05 * pid(s) * 1.5 * actuator * lead_over_lag(0.1, 0.6, omega) / (1.0 + s * 0.5)
                        : 0.0;
        EXPECT_LT(std::abs(by_power - droop), 1e-6) << code;
      }
    }
}

TEST(GovernorGgov1, DroopInTheSteadyState) {
  // Droop from the valve stroke: a speed deviation of 0.01 moves the stroke by -0.01/0.05, the power by Kturb
  // times that.
  ControlBench bench = bench_with({{"Rselect", -1.0}, {"Dm", 0.0}});
  bench.in.speed = 0.002;
  bench.run(400.0, 5e-3);
  EXPECT_NEAR(bench.out().Tm, 0.8 - 1.5 * 0.002 / 0.05, 1e-8);  // the slowest mode, 1/(R Kigov) = 13 s
  bench.in.speed = 0.0;
  bench.in.dPref = 0.02;
  bench.run(400.0, 5e-3);
  EXPECT_NEAR(bench.out().Tm, 0.8 + 1.5 * 0.02, 1e-8);
}

TEST(GovernorGgov1, BaseOfTheTurbineRating) {
  // Machine of 100 MVA with a turbine of 125 MW: 0.8 pu of the machine are 0.64 pu of the turbine.
  ControlBench bench = bench_with({{"Trate", 125.0}, {"Dm", 0.0}});
  EXPECT_NEAR(bench.state("valve"), 0.64 / 1.5 + 0.2, 1e-15);
  EXPECT_NEAR(bench.out().Tm, 0.8, 1e-15);
}

/// Load limiter: at any low speed the measured exhaust settles at Ldref/Kturb + Wfnl.
TEST(GovernorGgov1, LoadLimiterRegulatesToItsReferenceAndReleases) {
  ControlBench bench = bench_with({{"Ldref", 0.9}, {"Dm", 0.0}, {"Rselect", 0.0}, {"Aset", 99.0}});
  bench.in.speed = -0.003;  // isochronous: the governor would open to Vmax
  bench.run(200.0);
  EXPECT_NEAR(bench.out().Tm, 0.9, 1e-6);  // remainder: about 0.3 exp(-200/10)
  // The governor's integral is at Vmax = 1 pu. At speed +0.003 its output is 1 - 8 * 0.003 and falls by
  // 1.5 * 0.003 per second: it takes over the stroke, then 0.8 pu, after (0.2 - 0.024)/0.0045 = 39.1 s.
  bench.in.speed = 0.003;
  bench.run(38.0);
  EXPECT_NEAR(bench.out().Tm, 0.9, 1e-6);
  bench.run(12.0);
  EXPECT_NEAR(bench.out().Tm, 0.9 - 1.5 * 0.0045 * (50.0 - 39.1 - 0.4 - 0.5), 2e-4);  // Tact, Tb - Tc
}

TEST(GovernorGgov1, IntegralsDoNotWindUp) {
  ControlBench bench = bench_with({{"Ldref", 5.0}, {"Rselect", 0.0}, {"Kdgov", 0.0}, {"Aset", 99.0}});
  bench.in.speed = -0.01;
  bench.run(300.0, 5e-3);
  EXPECT_EQ(bench.state("integral"), 1.0);
  EXPECT_NEAR(bench.state("valve"), 1.0, 1e-12);  // a lag behind the integral
  EXPECT_EQ(bench.state("load"), 1.0);
  // the stroke falls without delay to 1 - 8 * 0.02 - 1.5 * 0.02 t, the valve at 0.1 pu/s
  bench.in.speed = 0.02;
  bench.run(0.5);
  EXPECT_NEAR(bench.state("valve"), 1.0 - 0.1 * 0.5, 1e-9);
  EXPECT_NEAR(bench.state("integral"), 1.0 - 1.5 * 0.02 * 0.5, 1e-9);
}

TEST(GovernorGgov1, ValveRespectsRateAndPositionLimits) {
  ControlBench bench = bench_with({{"Ropen", 0.05}, {"Rclose", -0.2}, {"Ka", 0.0}});
  const double start = bench.state("valve");
  bench.in.speed = -0.02;
  bench.run(0.5);
  EXPECT_NEAR(bench.state("valve"), start + 0.05 * 0.5, 1e-9);
  bench.in.speed = 0.05;
  bench.run(30.0);
  EXPECT_NEAR(bench.state("valve"), 0.15, 1e-9);  // Vmin
}

/// While the machine accelerates at a > Aset the stroke falls at Ka (a - Aset), else it may rise at Ka (Aset
/// - a). Once the washout has settled, the measured acceleration is the rate of change of the speed.
TEST(GovernorGgov1, AccelerationLimiterRampsTheStroke) {
  ControlBench bench =
      bench_with({{"Kpgov", 0.0}, {"Kdgov", 0.0}, {"Kigov", 0.0}, {"Aset", 0.01}, {"Ka", 5.0}, {"Ta", 0.05}});
  const double start = bench.state("accel");
  const double slope = 0.03, seconds = 2.0, step = 1e-3;
  for (double t = 0; t < seconds - step / 2; t += step) {
    bench.in.speed = slope * (t + step / 2);
    bench.run(step, step);
  }
  // The measured acceleration is slope (1 - exp(-t/Ta)), and its integral is slope (t - Ta). During the first
  // milliseconds the state follows `wanted` from above. Tolerance: step * slope * Ka, because the speed is
  // constant during each step.
  const double expected = start - 5.0 * (slope - 0.01) * seconds + 5.0 * slope * 0.05;
  EXPECT_NEAR(bench.state("accel"), expected, 3e-3);
  EXPECT_LT(bench.state("accel"), start - 0.15);
  bench.run(1.0);  // constant speed: the stroke recovers at Ka Aset = 0.05 pu/s
  const double low = bench.state("accel");
  bench.run(1.0);
  EXPECT_NEAR(bench.state("accel"), low + 0.05, 1e-6);
  bench.run(20.0);
  EXPECT_NEAR(bench.state("accel"), start, 1e-6);
}

TEST(GovernorGgov1, ExhaustTemperatureFollowsSpeedByNegativeDm) {
  ControlBench bench = bench_with({{"Dm", -0.5}, {"Kpgov", 0.0}, {"Kdgov", 0.0}, {"Kigov", 0.0}});
  const double valve = 0.8 / 1.5 + 0.2;
  bench.in.speed = -0.04;
  bench.run(60.0);
  EXPECT_NEAR(bench.state("exhaust"), valve * std::pow(0.96, -0.5), 1e-6);  // 0.015 exp(-60/5)
  EXPECT_NEAR(bench.out().Tm, 0.8, 1e-9);  // the power then does not depend on speed
}

TEST(GovernorGgov1, PowerControllerReturnsTheLoadToItsSetPoint) {
  // The plant delivers the turbine's power: P = Tm, at another speed.
  ControlBench bench = bench_with({{"Kimw", 0.01}, {"Dm", 0.0}});
  bench.in.speed = 0.001;
  for (int i = 0; i < 60000; ++i) {
    bench.in.P = bench.out().Tm;
    bench.run(0.01, 0.01);
  }
  EXPECT_NEAR(bench.out().Tm, 0.8, 1e-5);  // remainder: at most exp(-600 s Kimw/R)
  EXPECT_NEAR(bench.state("mw"), 0.001, 1e-5);
}

TEST(GovernorGgov1, RefusesParametersThatCannotBeIntegrated) {
  EXPECT_NE(bench_with({{"Ldref", 0.7}, {"Dm", 0.0}}).refused.find("Ldref = 0.7 pu"), std::string::npos);
  EXPECT_NE(bench_with({{"Vmax", 0.7}}).refused.find("above Vmax = 0.7 pu"), std::string::npos);
  EXPECT_NE(
      bench_with({{"Kturb", 1.0}, {"Vmax", 2.0}, {"Ldref", 5.0}}).refused.find("load limiter's largest"),
      std::string::npos);
  auto idle = ControlBench::rated();
  idle.Tm = idle.P = 0.0;
  EXPECT_NE(bench_with({{"Vmin", 0.3}, {"Dm", 0.0}}, idle).refused.find("below Vmin = 0.3 pu"),
            std::string::npos);
  using Change = std::pair<const char*, double>;
  for (const auto& [name, value] : {Change{"Teng", 0.5},
                                    {"Rselect", 2.0},
                                    {"Flag", 0.5},
                                    {"Tact", 0.0},
                                    {"Kturb", 0.0},
                                    {"Ropen", 0.0},
                                    {"Rclose", 0.1},
                                    {"Vmax", 0.1},
                                    {"minerr", 0.1},
                                    {"Tdgov", 0.0},
                                    {"Ta", 0.0},
                                    {"Tb", -1.0}})
    EXPECT_FALSE(bench_with({{name, value}}).problems.empty()) << name;
  Problems problems = bench_with({{"Teng", 0.5}}).problems;
  try {
    problems.raise();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("Teng = 0.5 s at GGOV1 (a transport delay"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace swingbank::sim::test
