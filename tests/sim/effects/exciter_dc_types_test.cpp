// IEEEX1, ESDC1A, ESDC2A, IEEET2: transfer functions against their diagrams, and their differences.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
const ControlBench::Changes kLinearDc = {{"TR", 0.03}, {"KA", 60.0}, {"TA", 0.08}, {"TB", 3.0},
                                         {"TC", 0.7},  {"KE", 0.9},  {"TE", 0.7},  {"KF", 0.05},
                                         {"TF", 0.9},  {"SE1", 0.0}, {"SE2", 0.0}};

TEST(ExciterDcTypes, LeadLagPrecedesTheRegulator) {
  for (const char* name : {"IEEEX1", "ESDC1A", "ESDC2A"})
    for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
      ControlBench bench(name, kLinearDc);
      ASSERT_TRUE(bench.problems.empty()) << name;
      EXPECT_LT(bench.largest_derivative(), 1e-11) << name;  // rounding times KA/TA
      const C s(0.0, omega);
      C forward = 60.0 * lead_over_lag(0.7, 3.0, omega) * lead_over_lag(0.0, 0.08, omega) / (0.9 + 0.7 * s);
      const C closed = forward / (1.0 + forward * 0.05 * s / (1.0 + 0.9 * s));
      // difference quotients with step 1e-6, amplified by KA/TA = 750
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - closed), 1e-6)
          << name;
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, &Signals<double>::Efd, omega) +
                         closed * lead_over_lag(0.0, 0.03, omega)),
                1e-6)
          << name;
    }
}

TEST(ExciterDcTypes, Ieeex1EqualsIeeet1_WithoutLeadLag) {
  const ControlBench::Changes same = {{"KA", 50.0}, {"TA", 0.1}, {"KF", 0.04}, {"E1", 3.0},
                                      {"SE1", 0.1}, {"E2", 4.0}, {"SE2", 0.3}};
  auto bypassed = same;
  bypassed["TB"] = 0.0;
  ControlBench one("IEEET1", same), other("IEEEX1", bypassed);
  for (ControlBench* bench : {&one, &other}) bench->in.Vc = 0.97;
  for (int step = 0; step < 5; ++step) {
    one.run(0.3);
    other.run(0.3);
    EXPECT_NEAR(one.out().Efd, other.out().Efd, 1e-12) << step;
  }
}

TEST(ExciterDcTypes, OnlyTypesOf1992LimitEfdAtZero) {
  for (const auto& [name, ends] :
       {std::pair{"IEEEX1", false}, {"ESDC1A", true}, {"EXDC2", false}, {"ESDC2A", true}}) {
    ControlBench bench(name, {{"VRMIN", -5.0}, {"TB", 0.0}});
    bench.in.dVref = -1.0;
    bench.run(20.0);
    if (ends)
      EXPECT_EQ(bench.out().Efd, 0.0) << name;
    else
      EXPECT_LT(bench.out().Efd, -4.0) << name;  // near VRMIN/KE
    bench.in.dVref = 0.0;
    bench.in.Vc = 0.0;
    bench.run(0.1);
    EXPECT_EQ(bench.out().Efd > 0.0, ends) << name << ": nothing was wound up";
  }
}

TEST(ExciterDcTypes, TerminalFedLimitsFollowTheVoltage) {
  ControlBench bench("ESDC2A", {{"VRMAX", 5.0}, {"SE1", 0.0}, {"SE2", 0.0}, {"KE", 1.0}});
  bench.in.dVref = 1.0;
  bench.in.V = 0.6;
  bench.run(30.0);
  EXPECT_NEAR(bench.out().Efd, 3.0, 0.05);  // V VRMAX/KE; Vr exceeds its limit by 1/(500 TA) of the demand
}

TEST(ExciterDcTypes, Ieeet2FeedsTheRegulatorBackThroughTwoLags) {
  const ControlBench::Changes values = {{"TR", 0.03}, {"KA", 60.0}, {"TA", 0.08}, {"KE", 0.9},  {"TE", 0.7},
                                        {"KF", 0.05}, {"TF1", 0.9}, {"TF2", 0.4}, {"SE1", 0.0}, {"SE2", 0.0}};
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("IEEET2", values);
    ASSERT_TRUE(bench.problems.empty());
    EXPECT_LT(bench.largest_derivative(), 1e-11);
    const C s(0.0, omega);
    const C regulator = 60.0 * lead_over_lag(0.0, 0.08, omega);
    const C back = 0.05 * s / ((1.0 + 0.9 * s) * (1.0 + 0.4 * s));
    const C closed = regulator / (1.0 + regulator * back) / (0.9 + 0.7 * s);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - closed), 1e-6);
  }
}

TEST(ExciterDcTypes, RefusesParametersThatCannotBeIntegrated) {
  EXPECT_NE(ControlBench("IEEEX1", {{"VRMAX", 1.0}}).refused.find("Vr"), std::string::npos);
  EXPECT_FALSE(ControlBench("IEEEX1", {{"TB", -1.0}}).problems.empty());
  EXPECT_FALSE(ControlBench("IEEET2", {{"TA", 0.0}}).problems.empty());
  EXPECT_FALSE(ControlBench("ESDC1A", {{"TE", 0.0}}).problems.empty());
}

}  // namespace
}  // namespace swingbank::sim::test
