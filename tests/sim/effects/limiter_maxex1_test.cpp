// MAXEX1: inverse time of the field voltage, gain, limit, latching, and operation together with MAXEX2.
#include <algorithm>

#include "sim/plant/equations.hpp"
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

const ControlBench::Changes kMaxex1Values = {
    {"EFDRATED", 2.5}, {"EFD1", 1.1},   {"TIME1", 60.0}, {"EFD2", 1.2}, {"TIME2", 30.0},
    {"EFD3", 1.5},     {"TIME3", 15.0}, {"EFDDES", 0.9}, {"KMX", 0.04}, {"VLOW", -0.05}};

TEST(LimiterMaxex1, OperatesAfterTheInverseTimeOfTheFieldVoltage) {
  // Hand-calculated characteristic; tolerance: steps of 2 ms and ten time constants of the measurement.
  for (const auto& [voltage, time] : {std::pair{1.15, 45.0}, {1.3, 25.0}, {2.0, 15.0}}) {
    ControlBench bench("MAXEX1", kMaxex1Values);
    ASSERT_TRUE(bench.problems.empty());
    bench.in.Efd = 2.5 * voltage;
    while (bench.state("timer") < 1.0 && bench.in.t < 100.0) bench.run(0.002, 0.002);
    EXPECT_NEAR(bench.in.t, time, 0.1) << voltage;
  }
  ControlBench current("MAXEX1", kMaxex1Values);
  current.in.Ifd = 2.5 * 2.0;
  current.run(20.0, 0.002);
  EXPECT_EQ(current.state("timer"), 0.0);  // independent of the current
}

TEST(LimiterMaxex1, LowersByItsGainWithoutAnIntegral) {
  ControlBench bench("MAXEX1", kMaxex1Values);
  bench.in.Efd = 2.5 * 1.2;
  bench.run(29.0, 0.002);
  EXPECT_EQ(bench.out().Vlimiter, 0.0);
  bench.run(2.0, 0.002);
  EXPECT_NEAR(bench.out().Vlimiter, 0.04 * 2.5 * (0.9 - 1.2), 1e-12);
  bench.run(60.0, 0.002);
  EXPECT_NEAR(bench.out().Vlimiter, 0.04 * 2.5 * (0.9 - 1.2), 1e-12);
  bench.in.Efd = 2.5 * 1.6;  // 0.07 pu: beyond VLOW
  bench.run(0.5, 0.002);
  EXPECT_EQ(bench.out().Vlimiter, -0.05);
  bench.in.Efd = 2.5 * 0.95;  // below the pickup, but it has operated and stays active
  bench.run(0.5, 0.002);
  EXPECT_NEAR(bench.out().Vlimiter, 0.04 * 2.5 * (0.9 - 0.95), 1e-12);
  bench.in.Efd = 2.5 * 0.8;
  bench.run(0.5, 0.002);
  EXPECT_EQ(bench.out().Vlimiter, 0.0);  // the limiter can only lower the reference
}

TEST(LimiterMaxex1, FadesInWithItsMeasurement) {
  ControlBench bench("MAXEX1", kMaxex1Values);
  bench.in.Efd = bench.state("Em") = 2.5 * 1.2;
  bench.state("timer") = 1.0 + 0.004;
  EXPECT_NEAR(bench.out().Vlimiter, 0.4 * 0.04 * 2.5 * (0.9 - 1.2), 1e-12);
  bench.state("timer") = 1.0;
  EXPECT_EQ(bench.out().Vlimiter, 0.0);
}

TEST(LimiterMaxex1, TimerResetsBelowPickupUnlessOperated) {
  ControlBench bench("MAXEX1", kMaxex1Values);
  bench.in.Efd = 2.5 * 1.3;
  bench.run(20.0, 0.002);
  EXPECT_NEAR(bench.state("timer"), 20.0 / 25.0, 2e-3);  // the measurement lags by 0.01 s
  bench.in.Efd = 2.0;
  bench.run(2.0, 0.002);
  EXPECT_LT(bench.state("timer"), 1e-8);  // exp(-20)
}

/// In a plant the exciter is evaluated after the limiter, which still measures the present field voltage.
TEST(LimiterMaxex1, MeasuresThePresentFieldVoltage) {
  plant::Plant plant;
  plant.bus = 0;
  plant.generation = {0.6, 0.15};
  const auto standard = [](const char* name) {
    const Effect* effect = library::compiled().find(name);
    return plant::Block{effect, effect->default_parameters()};
  };
  plant.machine = standard("GENROU");
  plant.controls = {standard("MAXEX1"), standard("SEXS")};
  const plant::Operating o = plant::operating_point(plant, 1.02, 100.0, Conventions::psse());
  const plant::PlantEquations<double> equations(plant);
  std::vector<double> m(static_cast<std::size_t>(equations.scratch())), dx(o.x.size()), x = o.x;
  const std::size_t measured = plant.machine.effect->states.size() + 1;
  double er, ei, ir, ii;
  Signals<double> s;
  s.Vpr = 1.02;
  s.Tm = o.Tm;
  s.Efd = o.Efd;
  const auto states = plant.controls[1].effect->states;
  const auto field = std::ranges::find(states, "Efd", &State::name);
  ASSERT_NE(field, states.end());
  x[measured + 1 + static_cast<std::size_t>(field - states.begin())] += 0.05;
  equations.emf(o.c.data(), x.data(), m.data(), er, ei);
  equations.from_grid(o.c.data(), x.data(), m.data(), er, ei, s, ir, ii);
  equations.derivative(o.c.data(), x.data(), m.data(), s, dx.data());
  EXPECT_NEAR(s.Efd, o.Efd + 0.05, 1e-12);
  EXPECT_NEAR(dx[measured], 0.05 / 0.01, 1e-9);
}

TEST(LimiterMaxex1, AddsToOtherLimiters) {
  ControlBench bench("MAXEX1", kMaxex1Values);
  bench.in.Vlimiter = -0.2;
  bench.in.Efd = 4.0;
  bench.run(16.0, 0.002);
  EXPECT_LT(bench.out().Vlimiter, -0.2);
}

TEST(LimiterMaxex1, RefusesUnsupportedParameters) {
  auto hot = ControlBench::rated();
  hot.Efd = 3.0;
  EXPECT_NE(ControlBench("MAXEX1", kMaxex1Values, hot).refused.find("Efd = 3.0000 pu"), std::string::npos);
  EXPECT_EQ(ControlBench("MAXEX1", {{"KMX", -1.0}, {"EFD2", 1.0}, {"TIME2", 90.0}}).problems.list().size(),
            3u);
}

}  // namespace
}  // namespace swingbank::sim::test
