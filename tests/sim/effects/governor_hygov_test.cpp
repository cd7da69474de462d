// HYGOV: transfer function of governor and water column, droop, gate velocity and limits without wind-up.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

const ControlBench::Changes kHygovValues = {{"R", 0.05}, {"r", 0.3},    {"Tr", 5.0},    {"Tf", 0.05},
                                            {"Tg", 0.5}, {"VELM", 0.2}, {"GMAX", 1.0},  {"GMIN", 0.0},
                                            {"TW", 1.0}, {"At", 1.2},   {"Dturb", 0.4}, {"qNL", 0.08}};

TEST(GovernorHygov, SmallSignalsFollowTheTransferFunction) {
  ControlBench bench("HYGOV", kHygovValues);
  EXPECT_LT(bench.largest_derivative(), 1e-14);
  const double gate = 0.8 / 1.2 + 0.08, At = 1.2, TW = 1.0, flow_at_work = gate - 0.08;
  for (const double omega : {0.01, 0.1, 1.0, 10.0}) {
    const std::complex<double> s(0.0, omega);
    const auto pi = (1.0 + 5.0 * s) / (0.3 * 5.0 * s) / (1.0 + 0.05 * s);
    const auto opening = -pi / (1.0 + 0.05 * pi) / (1.0 + 0.5 * s);
    // h = (q/g)^2 and TW q' = 1 - h about h = 1, q = g = gate.
    const auto flow = 1.0 / (1.0 + s * TW * gate / 2.0), head = 2.0 / gate * (flow - 1.0);
    const auto exact = opening * At * (flow + head * flow_at_work) - 0.4 * gate;
    const auto h = bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega);
    EXPECT_LT(std::abs(h - exact), 1e-7 * (1.0 + std::abs(exact))) << omega;  // difference step: 1e-6
  }
}

TEST(GovernorHygov, PermanentDroop) {
  ControlBench bench("HYGOV", kHygovValues);
  bench.in.speed = -0.005;
  bench.run(600.0, 5e-3);
  // The slowest mode has a time constant of about r Tr / R = 30 s; its remainder is 0.1 pu exp(-20).
  EXPECT_NEAR(bench.state("gate"), 0.8 / 1.2 + 0.08 + 0.005 / 0.05, 1e-8);
  EXPECT_NEAR(bench.out().Tm, 0.8 + 1.2 * 0.1 + 0.4 * 0.005 * bench.state("gate"), 1e-8);
}

TEST(GovernorHygov, GateRespectsVelocityAndPositionLimits) {
  ControlBench bench("HYGOV", kHygovValues);
  const double before = bench.state("desired");
  bench.in.speed = -0.2;
  bench.run(0.5);
  EXPECT_LE(bench.state("desired") - before, 0.2 * 0.5 + 1e-12);
  EXPECT_GT(bench.state("desired") - before, 0.2 * 0.4);  // after the filter's 0.05 s it is at the limit
  bench.run(20.0);
  EXPECT_EQ(bench.state("desired"), 1.0);
  bench.in.speed = 0.2;
  bench.run(0.5);
  EXPECT_LT(bench.state("desired"), 1.0 - 0.2 * 0.4);  // no delay by wind-up
}

TEST(GovernorHygov, DeadBandSubtractsItsWidthFromTheSpeed) {
  auto values = kHygovValues;
  values["db"] = 0.0006;
  values["Dturb"] = 0.0;
  ControlBench bench("HYGOV", values);
  bench.in.speed = 0.0005;
  EXPECT_LT(bench.largest_derivative(), 1e-14);
  bench.in.speed = 0.0016;
  EXPECT_NEAR(bench.derivative()[0], -0.001 / 0.05, 1e-12);  // the filter's input is the part beyond the edge
}

TEST(GovernorHygov, RefusesParametersThatCannotBeIntegrated) {
  Signals<double> idle = ControlBench::rated();
  idle.Tm = 0.0;
  EXPECT_NE(ControlBench("HYGOV", {{"qNL", 0.0}}, idle).refused, "");
  EXPECT_EQ(ControlBench("HYGOV", {{"GMAX", 0.7}}).refused, "desired outside its limits");
  EXPECT_FALSE(ControlBench("HYGOV", {{"Tf", 0.0}}).problems.empty());
}

}  // namespace
}  // namespace swingbank::sim::test
