// ESST1A: transfer function against its diagram, both input points of the stabiliser signal, limits,
// field-current limiter.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
const ControlBench::Changes kEsst1a = {{"TR", 0.02},   {"TC", 1.0},    {"TB", 5.0},     {"TC1", 0.3},
                                       {"TB1", 0.1},   {"KA", 150.0},  {"TA", 0.05},    {"KF", 0.03},
                                       {"TF", 0.8},    {"VRMAX", 6.0}, {"VRMIN", -4.0}, {"KC", 0.1},
                                       {"VIMAX", 0.2}, {"VIMIN", -0.1}};
C closed_loop(double omega) {
  const C forward = 150.0 * lead_over_lag(1.0, 5.0, omega) * lead_over_lag(0.3, 0.1, omega) *
                    lead_over_lag(0.0, 0.05, omega);
  const C back = C(0.0, omega) * 0.03 * lead_over_lag(0.0, 0.8, omega);
  return forward / (1.0 + forward * back);
}

TEST(ExciterEsst1a, TransferFunctionIsTheDiagrams) {
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("ESST1A", kEsst1a);
    EXPECT_LT(bench.largest_derivative(), 1e-11);  // rounding times KA/TA with TA = 0.05 s
    // difference quotients with step 1e-6, amplified by KA/TA = 3000
    EXPECT_LT(
        std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - closed_loop(omega)),
        1e-5);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, &Signals<double>::Efd, omega) +
                       closed_loop(omega) * lead_over_lag(0.0, 0.02, omega)),
              1e-5);
  }
}

TEST(ExciterEsst1a, StabiliserBehindTheRegulatorReachesOnlyTheRateFeedback) {
  auto values = kEsst1a;
  values["VOS"] = 2.0;
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("ESST1A", values);
    const C back = C(0.0, omega) * 0.03 * lead_over_lag(0.0, 0.8, omega);
    const C expected = 1.0 - closed_loop(omega) * back;
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - expected), 1e-5);
  }
}

TEST(ExciterEsst1a, OnlyTheUpperCeilingFallsWithTheFieldCurrent) {
  ControlBench bench("ESST1A", kEsst1a);
  bench.in.dVref = 0.1;
  bench.in.V = 0.9;
  bench.in.Ifd = 3.0;
  bench.run(30.0);
  EXPECT_DOUBLE_EQ(bench.out().Efd, 0.9 * 6.0 - 0.1 * 3.0);
  bench.in.dVref = -0.2;
  bench.run(30.0);
  EXPECT_DOUBLE_EQ(bench.out().Efd, -0.9 * 4.0);
}

TEST(ExciterEsst1a, TheRegulatorDoesNotWindUp) {
  auto values = kEsst1a;
  values["VAMAX"] = 4.0;
  values["KF"] = values["TB"] = values["TB1"] = 0.0;
  ControlBench bench("ESST1A", values);
  bench.in.dVref = 1.0;
  bench.run(30.0);
  EXPECT_EQ(bench.state("Va"), 4.0);
  bench.in.dVref = -1.0;
  bench.run(0.05);
  EXPECT_LT(bench.state("Va"), 4.0);
}

TEST(ExciterEsst1a, FieldLimiterActsAboveItsReference) {
  auto values = kEsst1a;
  values["KLR"] = 2.0;
  values["ILR"] = 1.5;  // field current at the operating point: 2 pu
  ControlBench bench("ESST1A", values);
  EXPECT_DOUBLE_EQ(bench.state("Va"), 2.0 + 2.0 * 0.5);
  EXPECT_DOUBLE_EQ(bench.out().Efd, 2.0);
  bench.in.Ifd = 1.4;
  EXPECT_DOUBLE_EQ(bench.out().Efd, 3.0);
  bench.in.Ifd = 2.5;
  EXPECT_DOUBLE_EQ(bench.out().Efd, 1.0);
}

TEST(ExciterEsst1a, ZeroTimeConstantsAreBypassed) {
  ControlBench bench("ESST1A",
                     {{"TR", 0.0}, {"TA", 0.0}, {"TB", 0.0}, {"TB1", 0.0}, {"TF", 0.0}, {"KA", 50.0}});
  EXPECT_TRUE(bench.problems.empty());
  bench.in.Vc = 0.98;
  EXPECT_NEAR(bench.out().Efd, 2.0 + 50.0 * 0.02, 1e-12);
}

TEST(ExciterEsst1a, RefusesParametersThatCannotBeIntegrated) {
  using Change = std::pair<const char*, double>;
  for (const auto& [name, value] :
       {Change{"UEL", 0.0}, {"VOS", 3.0}, {"KA", 0.0}, {"TA", -1.0}, {"KLR", -1.0}})
    EXPECT_FALSE(ControlBench("ESST1A", {{name, value}}).problems.empty()) << name;
  EXPECT_FALSE(ControlBench("ESST1A", {{"KF", 0.1}, {"TA", 0.0}}).problems.empty());
  EXPECT_FALSE(ControlBench("ESST1A", {{"KF", 0.1}, {"TF", 0.0}}).problems.empty());
  EXPECT_NE(ControlBench("ESST1A", {{"VIMAX", 0.001}}).refused.find("VIMAX"), std::string::npos);
}

}  // namespace
}  // namespace swingbank::sim::test
