// OEL1: inverse and definite time, run-back as a ramp and as a step, clamping, alarm, refusals.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using Values = ControlBench::Changes;

/// Parameters of OEL1 with `changes`. Ifd is 2.0 pu at the start.
Values values(const Values& changes) {
  Values all = {{"Ifdset", 2.8}, {"Ifcont", 2.4}, {"Tpickup", 10.0}, {"Runback", 50.0}};
  for (const auto& [name, value] : changes) all[name] = value;
  return all;
}
/// Seconds until it has operated at a constant field current [pu].
double oel1_operates_after(const Values& changes, double current) {
  ControlBench bench("OEL1", values(changes));
  EXPECT_TRUE(bench.problems.empty());
  bench.in.Ifd = current;
  while (bench.state("timer") < 1.0 && bench.in.t < 200.0) bench.run(0.01, 0.01);
  return bench.in.t;
}

TEST(LimiterOel1, TimeIsInverseOrDefinite) {
  for (const double beyond : {0.1, 0.5, 1.0, 2.0})
    EXPECT_NEAR(oel1_operates_after({}, 2.8 + beyond), 10.0 / beyond, 0.02) << beyond;
  for (const double beyond : {0.1, 2.0})
    EXPECT_NEAR(oel1_operates_after({{"Tpickup", -7.0}}, 2.8 + beyond), 7.0, 0.02) << beyond;
  EXPECT_GE(oel1_operates_after({}, 2.79), 200.0);
}

TEST(LimiterOel1, RampsToThePermanentLimitAndIsClampedThere) {
  ControlBench bench("OEL1", values({}));
  bench.in.Ifd = 3.8;
  bench.run(11.0, 0.01);
  EXPECT_NEAR(bench.out().Vlimiter, -1.0 / 50.0, 3e-4);  // for 1 s; the start is exact to one step
  bench.in.Ifd = 2.6;                                    // between permanent limit and pickup: it continues
  bench.run(4.0, 0.01);
  EXPECT_NEAR(bench.out().Vlimiter, -5.0 / 50.0, 3e-4);
  bench.in.Ifd = 2.3;
  const double held = bench.out().Vlimiter;
  bench.run(5.0, 0.01);
  EXPECT_EQ(bench.out().Vlimiter, held);
  EXPECT_LT(bench.state("timer"), 1e-8);
  bench.in.Ifd = 2.6;  // reset: it operates only above the pickup
  bench.run(5.0, 0.01);
  EXPECT_EQ(bench.out().Vlimiter, held);
  bench.in.Ifd = 3.8;
  bench.run(11.0, 0.01);
  EXPECT_NEAR(bench.out().Vlimiter, held - 1.0 / 50.0, 3e-4);
}

TEST(LimiterOel1, NegativeRunbackIsALastingStep) {
  ControlBench bench("OEL1", values({{"Runback", -0.03}}));
  bench.in.Ifd = 3.8;
  bench.run(9.9, 0.01);
  EXPECT_EQ(bench.out().Vlimiter, 0.0);
  bench.run(0.4, 0.002);
  EXPECT_NEAR(bench.out().Vlimiter, -0.03, 1e-8);  // exp(-30)
  bench.in.Ifd = 2.0;
  bench.run(10.0, 0.01);
  EXPECT_NEAR(bench.out().Vlimiter, -0.03, 1e-8);
}

TEST(LimiterOel1, TimerPausesBetweenPermanentLimitAndPickup) {
  ControlBench bench("OEL1", values({}));
  bench.in.Ifd = 3.8;
  bench.run(6.0, 0.01);
  bench.in.Ifd = 2.6;
  bench.run(20.0, 0.01);
  EXPECT_NEAR(bench.state("timer"), 0.6, 1e-12);
  bench.in.Ifd = 2.3;
  bench.run(1.0, 0.01);
  EXPECT_LT(bench.state("timer"), 1e-8);
}

TEST(LimiterOel1, MeasuresTheFieldVoltageAndHasNoOutputAsAlarm) {
  ControlBench voltage("OEL1", values({{"Vfdflag", 1.0}}));
  voltage.in.Ifd = 3.8;
  voltage.run(20.0, 0.01);
  EXPECT_EQ(voltage.out().Vlimiter, 0.0);
  voltage.in.Efd = 3.8;
  voltage.run(20.0, 0.01);
  EXPECT_NEAR(voltage.out().Vlimiter, -10.0 / 50.0, 3e-4);
  for (const double runback : {50.0, -0.03, 0.0}) {
    ControlBench alarm("OEL1", values({{"Alarm", 1.0}, {"Runback", runback}}));
    alarm.in.Ifd = 3.8;
    alarm.run(20.0, 0.01);
    EXPECT_EQ(alarm.out().Vlimiter, 0.0) << runback;
  }
}

TEST(LimiterOel1, RefusesUnsupportedParameters) {
  auto hot = ControlBench::rated();
  hot.Ifd = 3.0;
  EXPECT_NE(ControlBench("OEL1", values({}), hot).refused.find("Ifd = 3.0000 pu"), std::string::npos);
  EXPECT_EQ(
      ControlBench("OEL1", values({{"Ifcont", 3.0}, {"Tpickup", 0.0}, {"Vfdflag", 0.5}, {"Tset", -1.0}}))
          .problems.list()
          .size(),
      4u);
  // Vfdflag first, in PowerWorld's order: Tset is read as Ifcont.
  const Effect& oel1 = *library::compiled().find("OEL1");
  Problems problems;
  const double other[] = {0.0, 1.05, 1.5, 10.0, 100.0, 0.0, 999.0, 1.0, 0.0};
  oel1.check(nullptr, other, "other.dyr:1", problems);
  EXPECT_FALSE(problems.empty());
  EXPECT_NE(oel1.remark(oel1.default_parameters().data()).find("Ifdmax = 4 pu is not modelled"),
            std::string::npos);
}

}  // namespace
}  // namespace swingbank::sim::test
