// MAXEX2: inverse time, reset, latch, ramp, limit and return.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

const ControlBench::Changes kMaxex2Values = {
    {"EFDRATED", 2.5}, {"EFD1", 1.1},   {"TIME1", 60.0}, {"EFD2", 1.2}, {"TIME2", 30.0},
    {"EFD3", 1.5},     {"TIME3", 15.0}, {"EFDDES", 1.0}, {"KMX", 0.01}, {"VLOW", -0.05}};

/// Seconds until the limiter has operated at a constant field current [of rated].
double time_to_operate(double current) {
  ControlBench bench("MAXEX2", kMaxex2Values);
  bench.in.Ifd = 2.5 * current;
  while (bench.state("timer") < 1.0 && bench.in.t < 100.0) bench.run(0.01, 0.01);
  return bench.in.t;
}

TEST(LimiterMaxex2, OperatesAfterTheInverseTime) {
  // Hand-calculated characteristic; tolerance: steps of 0.01 s and one step for rounding.
  for (const auto& [current, time] :
       {std::pair{1.15, 45.0}, {1.2, 30.0}, {1.3, 25.0}, {1.5, 15.0}, {2.0, 15.0}})
    EXPECT_NEAR(time_to_operate(current), time, 0.02) << current;
  EXPECT_GE(time_to_operate(1.09), 100.0);
}

TEST(LimiterMaxex2, TimerResetsBelowPickupUnlessOperated) {
  ControlBench bench("MAXEX2", kMaxex2Values);
  bench.in.Ifd = 2.5 * 1.3;
  bench.run(20.0, 0.01);
  EXPECT_NEAR(bench.state("timer"), 20.0 / 25.0, 1e-12);
  bench.in.Ifd = 2.0;
  bench.run(2.0, 0.01);
  EXPECT_LT(bench.state("timer"), 1e-8);  // exp(-20)
  EXPECT_EQ(bench.out().Vlimiter, 0.0);
}

TEST(LimiterMaxex2, RampsToItsLimitAndReturnsWithoutWindUp) {
  ControlBench bench("MAXEX2", kMaxex2Values);
  bench.in.Ifd = 2.5 * 1.2;
  bench.run(31.0, 0.01);
  // 0.01 (2.5 - 3.0) pu/s for 1 s; the start is exact to one step
  EXPECT_NEAR(bench.out().Vlimiter, -0.005, 1e-4);
  bench.run(60.0, 0.01);
  EXPECT_EQ(bench.out().Vlimiter, -0.05);
  bench.in.Ifd = 2.0;  // below pickup, but it has operated and still regulates to EFDDES
  bench.run(4.0, 0.01);
  EXPECT_NEAR(bench.out().Vlimiter, -0.05 + 0.01 * 0.5 * 4.0, 1e-12);
  bench.run(60.0, 0.01);
  EXPECT_EQ(bench.out().Vlimiter, 0.0);
}

TEST(LimiterMaxex2, AddsToOtherLimiters) {
  ControlBench bench("MAXEX2", kMaxex2Values);
  bench.in.Vlimiter = -0.2;
  bench.in.Ifd = 4.0;
  bench.run(16.0, 0.01);
  EXPECT_LT(bench.out().Vlimiter, -0.2);
}

TEST(LimiterMaxex2, RefusesUnsupportedParameters) {
  auto hot = ControlBench::rated();
  hot.Ifd = 3.0;
  EXPECT_NE(ControlBench("MAXEX2", kMaxex2Values, hot).refused.find("Ifd = 3.0000 pu"), std::string::npos);
  EXPECT_EQ(ControlBench("MAXEX2", {{"M", 2.0}, {"EFD2", 1.0}, {"TIME2", 90.0}}).problems.list().size(), 3u);
}

TEST(LimiterMaxex2, LimitsTheFieldVoltage_WhenMSelectsIt) {
  ControlBench::Changes values = kMaxex2Values;
  values["M"] = 0.0;
  ControlBench bench("MAXEX2", values);
  ASSERT_TRUE(bench.problems.empty());
  bench.in.Ifd = 2.5 * 2.0;
  bench.run(20.0, 0.01);
  EXPECT_EQ(bench.state("timer"), 0.0);  // independent of the current
  bench.in.Efd = 2.5 * 1.3;
  bench.run(20.0, 0.01);
  EXPECT_NEAR(bench.state("timer"), 20.0 / 25.0, 1e-12);
  bench.run(10.0, 0.01);
  // 0.01 (2.5 - 3.25) pu/s for 5 s; the start is exact to one step
  EXPECT_NEAR(bench.out().Vlimiter, -0.0375, 1e-4);
  auto hot = ControlBench::rated();
  hot.Efd = 3.0;
  EXPECT_NE(ControlBench("MAXEX2", values, hot).refused.find("Efd = 3.0000 pu"), std::string::npos);
}

}  // namespace
}  // namespace swingbank::sim::test
