// LCFB1: hand-calculated PI control, limits of error and output, and its output for both kinds of governors.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using Values = ControlBench::Changes;

TEST(SetpointLcfb1, IntegratesTheLaggedPowersError) {
  ControlBench bench("LCFB1", {{"TPELEC", 2.0}, {"KP", 0.3}, {"KI", 0.1}, {"EMAX", 1.0}, {"IRMAX", 1.0}});
  ASSERT_TRUE(bench.problems.empty());
  EXPECT_EQ(bench.out().dGref, 0.0);
  EXPECT_EQ(bench.largest_derivative(), 0.0);
  bench.in.P = 0.75;
  bench.run(3.0, 2e-3);
  const double lagged = 0.05 * (1 - std::exp(-1.5));
  EXPECT_NEAR(bench.out().dGref, 0.3 * lagged + 0.1 * (0.05 * 3.0 - 2.0 * lagged), 1e-9);
}

TEST(SetpointLcfb1, EveryLimitActs) {
  const Values fast = {{"TPELEC", 0.0}, {"EMAX", 0.02}, {"KI", 0.1}, {"DB", 0.01}, {"IRMAX", 0.005}};
  ControlBench bench("LCFB1", fast);
  bench.in.P = 0.795;  // within the band
  bench.run(1.0);
  EXPECT_EQ(bench.out().dGref, 0.0);
  bench.in.P = 0.785;  // 0.005 beyond it
  bench.run(1.0);
  EXPECT_NEAR(bench.out().dGref, 0.0005, 1e-12);
  bench.in.P = 0.5;  // limit of the error
  bench.run(1.0);
  EXPECT_NEAR(bench.out().dGref, 0.0025, 1e-12);
  bench.run(10.0);  // limit of the output
  EXPECT_NEAR(bench.out().dGref, 0.005, 1e-12);
  bench.in.P = 1.1;  // no wind-up
  bench.run(1.0);
  EXPECT_NEAR(bench.out().dGref, 0.003, 1e-12);
}

TEST(SetpointLcfb1, FlagsSelectItsInputs) {
  const auto after = [](double by_power, double by_speed) {
    ControlBench bench("LCFB1", {{"PBF", by_power},
                                 {"FBF", by_speed},
                                 {"FB", 10.0},
                                 {"TPELEC", 0.0},
                                 {"EMAX", 1.0},
                                 {"KI", 0.1},
                                 {"IRMAX", 1.0}});
    bench.in.P = 0.7;
    bench.in.speed = 0.002;
    bench.run(1.0);
    return bench.out().dGref;
  };
  EXPECT_EQ(after(0, 0), 0.0);
  EXPECT_NEAR(after(1, 0), 0.01, 1e-12);
  EXPECT_NEAR(after(0, 1), -0.002, 1e-12);
  EXPECT_NEAR(after(1, 1), 0.008, 1e-12);
  EXPECT_EQ(ControlBench("LCFB1", {{"PBF", 2.0}, {"EMAX", -1.0}}).problems.list().size(), 2u);
}

// The reference has the governor's unit: a speed reference changes the power through the droop.
TEST(SetpointLcfb1, MovesTheReferenceInTheGovernorsOwnUnit) {
  const auto moved = [](const char* governor, const Values& changes) {
    ControlBench bench(governor, changes);
    const double before = bench.out().Tm;
    bench.in.dGref = 0.001;
    bench.run(900.0, 1e-2);
    return bench.out().Tm - before;
  };
  EXPECT_NEAR(moved("TGOV1", {{"R", 0.05}}), 0.02, 1e-6);
  EXPECT_NEAR(moved("IEEEG1", {}), 0.001, 1e-6);
  EXPECT_NEAR(moved("IEEEG3", {{"DELTA", 0.1}}), 0.02, 1e-6);
  EXPECT_NEAR(moved("GAST", {{"AT", 2.0}}), 0.001, 1e-6);
}

}  // namespace
}  // namespace swingbank::sim::test
