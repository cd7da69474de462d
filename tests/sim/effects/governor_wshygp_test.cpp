// WSHYGP: transfer function against the diagram with both feedbacks, the turbine's rating, backlash, limits.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

Values wshygp_with(const Values& more) {
  Values v = {{"TD", 0.07},    {"KI", 0.5},    {"TF", 0.12},   {"KD", 0.6},      {"KP", 1.5},
              {"R", 0.04},     {"TT", 0.3},    {"KG", 3.0},    {"TP", 0.2},      {"GV1", 0.1},
              {"PGV1", 0.0},   {"GV2", 0.5},   {"PGV2", 0.45}, {"GV3", 0.9},     {"PGV3", 0.95},
              {"ATURB", -1.0}, {"BTURB", 0.5}, {"TTURB", 0.9}, {"VELOPEN", 0.1}, {"VELCLOSE", 0.2}};
  for (const auto& [name, x] : more) v[name] = x;
  return v;
}

TEST(GovernorWshygp, TransferFunctionIsTheDiagrams) {
  for (const auto& more : {Values{},
                           {{"TT", 0.0}},
                           {{"TT", 0.0}, {"TD", 0.0}},
                           {{"TT", 0.0}, {"KI", 0.0}},
                           {{"TP", 0.0}},
                           {{"KD", 0.0}},
                           {{"TTURB", 0.0}},
                           {{"TRATE", 80.0}},
                           {{"TT", 0.0}, {"TRATE", 80.0}}}) {
    const Values v = wshygp_with(more);
    // the bench's machine has 100 MVA
    const double base = v.contains("TRATE") ? 100.0 / 80.0 : 1.0;
    if (base > 1.0 && v.at("TT") > 0.0) continue;  // beyond the curve's last point, extrapolated linearly
    for (const double omega : {0.02, 0.3, 4.0}) {
      ControlBench bench("WSHYGP", v);
      ASSERT_TRUE(bench.problems.empty());
      bench = ControlBench("WSHYGP", [&] {
        Values w = v;
        w["PMAX"] = 2.0;
        return w;
      }());
      ASSERT_EQ(bench.refused, "");
      EXPECT_LT(bench.largest_derivative(), 1e-13);
      EXPECT_NEAR(bench.out().Tm, 0.8, 1e-14);
      const C s(0.0, omega);
      const C pid = 1.5 + v.at("KI") / s + s * v.at("KD") / (1.0 + s * 0.12);
      const C filter = lead_over_lag(0.0, v.at("TD"), omega);
      const C servo = 3.0 * lead_over_lag(0.0, v.at("TP"), omega) / s;
      const C gate = servo / (1.0 + servo);
      const C by_cv = v.at("TT") == 0.0 ? C(0.04) : C(0.0);
      const C cv = filter * pid / (1.0 + by_cv * filter * pid);
      const C turbine = 0.5 / 0.4 / base * lead_over_lag(-v.at("TTURB"), 0.5 * v.at("TTURB"), omega);
      const C exact = -cv * gate * turbine;
      EXPECT_LT(std::abs(bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega) - exact),
                1e-7 * (1.0 + std::abs(exact)))
          << omega;
      EXPECT_LT(std::abs(bench.response(&Signals<double>::dPref, &Signals<double>::Tm, omega) + 0.04 * exact),
                1e-7 * (1.0 + std::abs(exact)));
      const C by_power = v.at("TT") == 0.0 ? C(0.0) : 0.04 * base * lead_over_lag(0.0, 0.3, omega) * exact;
      EXPECT_LT(std::abs(bench.response(&Signals<double>::P, &Signals<double>::Tm, omega) - by_power),
                1e-7 * (1.0 + std::abs(exact)));
    }
  }
}

TEST(GovernorWshygp, SteadyStatePowerFollowsTheDroop) {
  ControlBench bench("WSHYGP", wshygp_with({{"TT", 0.0}, {"db1", 0.001}}));
  const double before = bench.state("gate");
  EXPECT_NEAR(before, 0.5 + 0.35 / 1.25, 1e-14);
  bench.in.speed = 0.005;
  bench.run(900.0, 1e-2);
  EXPECT_NEAR(bench.state("gate"), before - 0.004 / 0.04, 1e-6);
}

TEST(GovernorWshygp, SignOfVelcloseDoesNotMatter) {
  for (const double sign : {1.0, -1.0}) {
    ControlBench bench("WSHYGP", wshygp_with({{"VELCLOSE", 0.2 * sign}}));
    ASSERT_TRUE(bench.problems.empty());
    bench.in.speed = 0.3;
    bench.run(2.0);
    const double first = bench.state("gate");
    bench.run(0.5);
    EXPECT_NEAR(first - bench.state("gate"), 0.1, 1e-9);
    bench.run(20.0);
    EXPECT_EQ(bench.state("gate"), 0.0);
  }
}

TEST(GovernorWshygp, BacklashDelaysReversalOfThePower) {
  ControlBench bench("WSHYGP", wshygp_with({{"TT", 0.0}, {"db2", 0.01}}));
  bench.in.dPref = 0.05;
  bench.run(900.0, 1e-2);
  const double there = bench.state("position");
  EXPECT_NEAR(bench.state("gate") - there, 0.01, 1e-5);
  EXPECT_NEAR(there, 0.78 + 0.05, 1e-5);
  bench.in.dPref = 0.049;
  bench.run(0.5);
  EXPECT_LT(bench.state("gate"), there + 0.01);
  EXPECT_NEAR(bench.state("position"), there, 1e-6);  // still within the backlash
}

TEST(GovernorWshygp, RefusesUnmodelledOptions) {
  using Change = std::pair<const char*, double>;
  for (const auto& [name, value] : {Change{"err", 0.001},
                                    {"TF", 0.0},
                                    {"KG", 0.0},
                                    {"VELCLOSE", 0.0},
                                    {"PMAX", 0.0},
                                    {"BTURB", 0.0},
                                    {"PGV3", 0.4},
                                    {"KP", -1.0}})
    EXPECT_EQ(ControlBench("WSHYGP", wshygp_with({{name, value}})).problems.list().size(), 1u) << name;
  EXPECT_FALSE(ControlBench("WSHYGP", wshygp_with({{"KP", 0.0}, {"KI", 0.0}})).problems.empty());
}

}  // namespace
}  // namespace swingbank::sim::test
