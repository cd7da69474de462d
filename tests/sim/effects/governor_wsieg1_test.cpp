// WSIEG1: equality with IEEEG1 while the parts that IEEEG1 lacks are inactive, the valve's curve, its
// backlash, blocked directions.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

const ControlBench::Changes kGateCurve = {{"GV1", 0.0},  {"PGV1", 0.0}, {"GV2", 0.5},
                                          {"PGV2", 0.7}, {"GV3", 1.0},  {"PGV3", 1.0}};

TEST(GovernorWsieg1, EqualsIeeeg1_WhenItsOwnPartsAreOff) {
  ControlBench one("IEEEG1", {{"db", 0.0003}}), other("WSIEG1", {{"db1", 0.0003}});
  ASSERT_TRUE(other.problems.empty());
  for (ControlBench* bench : {&one, &other}) bench->in.speed = -0.004;
  for (int step = 0; step < 5; ++step) {
    one.run(0.7);
    other.run(0.7);
    EXPECT_DOUBLE_EQ(one.out().Tm, other.out().Tm) << step;
  }
}

TEST(GovernorWsieg1, InitialValvePositionFollowsTheCurve) {
  ControlBench bench("WSIEG1", kGateCurve);  // 0.8 pu: a third of the way from 0.5 to 1
  EXPECT_NEAR(bench.state("valve"), 0.5 + 0.5 / 3.0, 1e-14);
  EXPECT_NEAR(bench.out().Tm, 0.8, 1e-14);
  EXPECT_LT(bench.largest_derivative(), 1e-13);
  bench.in.dPref = -0.3;  // to an opening of 0.3667
  bench.run(200.0, 5e-3);
  EXPECT_NEAR(bench.out().Tm, (0.5 + 0.5 / 3.0 - 0.3) * 0.7 / 0.5, 1e-9);
}

TEST(GovernorWsieg1, PointsMustAscend) {
  auto values = kGateCurve;
  values["PGV3"] = 0.6;
  EXPECT_FALSE(ControlBench("WSIEG1", values).problems.empty());
  values = kGateCurve;
  values["GV5"] = 0.9;
  EXPECT_FALSE(ControlBench("WSIEG1", values).problems.empty());
}

TEST(GovernorWsieg1, BacklashDelaysReversalOfTheGate) {
  ControlBench bench("WSIEG1", {{"db2", 0.01}, {"T1", 0.0}, {"PMAX", 2.0}});
  bench.in.dPref = 0.05;
  bench.run(30.0, 5e-3);
  EXPECT_NEAR(bench.state("gate"), 0.85, 1e-6);  // the governor measures the gate and regulates it
  EXPECT_NEAR(bench.state("valve"), 0.86, 1e-6);
  bench.in.dPref = 0.04;
  bench.run(0.05);
  EXPECT_LT(bench.state("valve"), 0.86);
  EXPECT_NEAR(bench.state("gate"), 0.85, 1e-6);  // still within the backlash
  bench.run(30.0, 5e-3);
  EXPECT_NEAR(bench.state("gate"), 0.84, 1e-6);
  EXPECT_NEAR(bench.state("valve"), 0.83, 1e-6);
}

TEST(GovernorWsieg1, CodeBlocksDirectionsOfMotion) {
  for (const double code : {1.0, 2.0, 3.0})
    for (const double asked : {-0.1, 0.1}) {
      ControlBench bench("WSIEG1", {{"IBLOCK", code}, {"PMIN", 0.0}, {"PMAX", code == 1.0 ? 1.0 : 0.0}});
      EXPECT_TRUE(bench.problems.empty()) << code;
      bench.in.dPref = asked;
      bench.run(5.0);
      const bool blocked = asked < 0 ? code != 2.0 : code != 1.0;
      EXPECT_EQ(bench.state("valve") == 0.8, blocked) << code << " " << asked;
    }
}

TEST(GovernorWsieg1, RefusesUnmodelledOptions) {
  using Change = std::pair<const char*, double>;
  for (const auto& [name, value] :
       {Change{"err", 0.001}, {"IBLOCK", 4.0}, {"db2", -0.1}, {"K4", 0.3}, {"T3", 0.0}})
    EXPECT_FALSE(ControlBench("WSIEG1", {{name, value}}).problems.empty()) << name;
}

}  // namespace
}  // namespace swingbank::sim::test
