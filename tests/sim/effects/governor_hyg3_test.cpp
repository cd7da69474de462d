// HYG3: transfer functions of both regulators, gate curve and its ends, hand-calculated water column, limits.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

Values hyg3_with(const Values& more) {
  Values v = {{"RGATE", 0.04}, {"RELEC", 0.02}, {"TT", 0.4},   {"TD", 0.06},   {"K2", 1.2},  {"KI", 0.6},
              {"K1", 0.3},     {"TF", 0.15},    {"KG", 4.0},   {"TP", 0.1},    {"GV1", 0.1}, {"PGV1", 0.05},
              {"GV2", 0.5},    {"PGV2", 0.45},  {"GV3", 0.9},  {"PGV3", 0.95}, {"GV4", 0.0}, {"PGV4", 0.0},
              {"GV5", 0.0},    {"PGV5", 0.0},   {"GV6", 0.0},  {"PGV6", 0.0},  {"H0", 1.1},  {"QNL", 0.1},
              {"TW", 0.8},     {"AT", 1.1},     {"DTURB", 0.3}};
  for (const auto& [name, x] : more) v[name] = x;
  return v;
}

TEST(GovernorHyg3, TransferFunctionsAreTheDiagrams) {
  for (const auto& more : {Values{},
                           {{"TD", 0.0}},
                           {{"TT", 0.0}, {"TP", 0.0}},
                           {{"KI", 0.0}},
                           {{"TW", 0.0}},
                           {{"FLAG", 0.0}},
                           {{"FLAG", 0.0}, {"TD", 0.0}},
                           {{"TRATE", 120.0}}}) {
    const Values v = hyg3_with(more);
    const double base = v.contains("TRATE") ? 100.0 / 120.0 : 1.0;
    for (const double omega : {0.02, 0.3, 4.0}) {
      ControlBench bench("HYG3", v);
      ASSERT_TRUE(bench.problems.empty());
      ASSERT_EQ(bench.refused, "");
      EXPECT_LT(bench.largest_derivative(), 1e-13);
      EXPECT_NEAR(bench.out().Tm, 0.8, 1e-14);
      const double flow = bench.state("flow"), pgv = flow / std::sqrt(1.1), gv = bench.state("gate");
      const double slope = 0.5 / 0.4;
      EXPECT_NEAR(gv, 0.5 + (pgv - 0.45) / slope, 1e-14);
      EXPECT_NEAR(1.1 * 1.1 * (flow - 0.1), 0.8 * base, 1e-14);
      const C s(0.0, omega);
      const C filter = lead_over_lag(0.0, v.at("TD"), omega), wash = s / (1.0 + s * 0.15);
      const bool pid = !v.contains("FLAG");
      const C regulator = pid ? filter * (1.2 + v.at("KI") / s + 0.3 * wash) : v.at("KI") / s;
      const C cv = regulator / (1.0 + 0.04 * regulator);  // with gate feedback
      const C servo = 4.0 * lead_over_lag(0.0, v.at("TP"), omega) / s, gate = servo / (1.0 + servo);
      // TW dq = H0 - (q/pgv)^2; Pm = At (q/pgv)^2 (q - qNL)
      const double g = 2.0 * flow / (pgv * pgv);
      const C q = v.at("TW") > 0.0 ? g * flow / pgv / (v.at("TW") * s + g) : C(std::sqrt(1.1));
      const C head = g * (q - flow / pgv);
      const C turbine = 1.1 * (head * (flow - 0.1) + 1.1 * q) * slope / base;
      const C moved = cv * gate * turbine;
      const C felt = pid ? C(1.0) : filter * (0.3 * wash + 1.2 * wash * wash);
      const C exact = -felt * moved - 0.3 * gv / base;
      const auto close = [&](const C& h, const C& want, const char* what) {
        EXPECT_LT(std::abs(h - want), 1e-7 * (1.0 + std::abs(exact))) << what << " " << omega;
      };
      close(bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega), exact, "speed");
      close(bench.response(&Signals<double>::dPref, &Signals<double>::Tm, omega), 0.06 * moved, "dPref");
      close(bench.response(&Signals<double>::P, &Signals<double>::Tm, omega),
            -0.02 * base * lead_over_lag(0.0, v.at("TT"), omega) * moved, "P");
    }
  }
}

TEST(GovernorHyg3, GateCurveSpansZeroToFullPower) {
  const auto gate = [](double pm, const Values& more) {
    Signals<double> at = ControlBench::rated();
    at.Tm = at.P = pm;
    Values v = hyg3_with({{"H0", 1.0}, {"AT", 1.0}, {"QNL", 0.0}});
    for (const auto& [name, x] : more) v[name] = x;
    ControlBench bench("HYG3", v, at);
    EXPECT_EQ(bench.refused, "");
    return bench.state("gate");
  };
  EXPECT_NEAR(gate(0.03, {}), 0.06, 1e-14);                                // between (0, 0) and (0.1, 0.05)
  EXPECT_NEAR(gate(0.97, {}), 0.94, 1e-14);                                // between (0.9, 0.95) and (1, 1)
  EXPECT_NEAR(gate(0.2, {{"PGV1", 0.0}}), 0.1 + 0.4 * 0.2 / 0.45, 1e-14);  // no power up to 0.1
  Values none;
  for (const char* point : {"GV1", "PGV1", "GV2", "PGV2", "GV3", "PGV3"}) none[point] = 0.0;
  EXPECT_NEAR(gate(0.7, none), 0.7, 1e-14);
}

TEST(GovernorHyg3, DeadBandIsInHertzAndBacklashInMegawatts) {
  ControlBench bench(
      "HYG3", hyg3_with({{"DBH", 0.06}, {"DBL", -0.12}, {"DTURB", 0.0}, {"RELEC", 0.0}, {"db2", 2.0}}));
  const double before = bench.state("gate");
  bench.in.speed = 0.0009;  // edges of the dead-band: 0.001 and -0.002
  bench.run(5.0);
  EXPECT_EQ(bench.state("gate"), before);
  bench.in.speed = 0.002;
  bench.run(900.0, 1e-2);
  EXPECT_NEAR(bench.state("position"), before - 0.001 / 0.04, 1e-5);
  EXPECT_NEAR(bench.state("position") - bench.state("gate"), 0.02, 1e-4);  // 2 MW of 100 MW
  bench.in.speed = -0.004;
  bench.run(900.0, 1e-2);
  EXPECT_NEAR(bench.state("position"), before + 0.002 / 0.04, 1e-5);
}

TEST(GovernorHyg3, GateRespectsVelocityAndPositionLimits) {
  for (const double flag : {1.0, 0.0}) {
    ControlBench bench(
        "HYG3",
        hyg3_with({{"FLAG", flag}, {"PMAX", 0.9}, {"PMIN", 0.2}, {"VELOPEN", 0.1}, {"VELCLOSE", -0.15}}));
    ASSERT_EQ(bench.refused, "");
    bench.in.dPref = -20.0;
    bench.run(2.0);
    const double first = bench.state("gate");
    bench.run(0.5);
    EXPECT_NEAR(first - bench.state("gate"), 0.075, 1e-9);
    bench.run(20.0);
    EXPECT_NEAR(bench.state("gate"), 0.2, 1e-9);
    EXPECT_GE(bench.state("integral"), 0.2);  // no wind-up
    bench.in.dPref = 20.0;
    bench.run(2.5);
    const double rising = bench.state("gate");
    bench.run(0.5);
    EXPECT_NEAR(bench.state("gate") - rising, 0.05, 1e-9);
    bench.run(20.0);
    EXPECT_NEAR(bench.state("gate"), 0.9, 1e-9);
  }
}

TEST(GovernorHyg3, RefusesUnmodelledOptions) {
  using Change = std::pair<const char*, double>;
  for (const auto& [name, value] : {Change{"FLAG", 2.0},
                                    {"TF", 0.0},
                                    {"KG", 0.0},
                                    {"VELCLOSE", 0.1},
                                    {"GV1", -1.0},
                                    {"PGV3", 0.4},
                                    {"DBL", 0.1},
                                    {"PMIN", 1.0}})
    EXPECT_EQ(ControlBench("HYG3", hyg3_with({{name, value}})).problems.list().size(), 1u) << name;
  EXPECT_FALSE(ControlBench("HYG3", hyg3_with({{"EPS", 0.01}, {"DBH", 0.036}})).problems.empty());
  EXPECT_FALSE(ControlBench("HYG3", hyg3_with({{"FLAG", 0.0}, {"KI", 0.0}})).problems.empty());
  Signals<double> idle = ControlBench::rated();
  idle.Tm = -0.2;
  EXPECT_NE(ControlBench("HYG3", hyg3_with({}), idle).refused.find("shut"), std::string::npos);
}

}  // namespace
}  // namespace swingbank::sim::test
