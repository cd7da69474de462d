// EXPIC1: transfer functions against the diagram with and without an exciter, source, limits, refusals.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

Values expic1_with(const Values& more) {
  Values v = {{"TR", 0.02}, {"KA", 3.0},  {"TA1", 0.8}, {"TA2", 0.05}, {"TA3", 0.2}, {"TA4", 0.4},
              {"KF", 0.3},  {"TF1", 1.1}, {"TF2", 0.3}, {"KP", 5.0},   {"KI", 1.5},  {"KC", 0.0},
              {"KE", 0.9},  {"TE", 0.6},  {"E1", 1.0},  {"SE1", 0.05}, {"E2", 3.0},  {"SE2", 0.3}};
  for (const auto& [name, x] : more) v[name] = x;
  return v;
}

TEST(ExciterExpic1, TransferFunctionIsTheDiagrams) {
  for (const auto& more : {Values{},
                           {{"TE", 0.0}},
                           {{"TA2", 0.0}},
                           {{"TA4", 0.0}},
                           {{"TA2", 0.0}, {"TA4", 0.0}},
                           {{"KF", 0.0}},
                           {{"TF2", 0.0}, {"TA3", 0.0}},
                           {{"TF1", 0.0}, {"TA3", 0.0}},
                           {{"KP", 0.0}, {"KI", 0.0}, {"VR1", 9.0}, {"VRMAX", 9.0}}}) {
    const Values v = expic1_with(more);
    const double VB = v.at("KP") > 0.0 ? std::abs(C(5.0, 1.5 * 0.8)) : 1.0;
    const double B =
        [&] {  // A and B of the saturation B (E - A)^2/E through the two points
          const double r = std::sqrt(0.05 / 0.9);
          const double A = (1.0 - r * 3.0) / (1.0 - r);
          return std::pair{A, 0.9 / ((3.0 - A) * (3.0 - A))};
        }()
            .second;
    const double A = 3.0 - std::sqrt(0.9 / B);
    const double slope = 2.0 * B * (2.0 - A), saturated = B * (2.0 - A) * (2.0 - A);
    for (const double omega : {0.1, 1.0, 7.0}) {
      ControlBench bench("EXPIC1", v);
      ASSERT_TRUE(bench.problems.empty());
      ASSERT_EQ(bench.refused, "");
      EXPECT_LT(bench.largest_derivative(), 1e-13);
      EXPECT_NEAR(bench.out().Efd, 2.0, 1e-14);
      const bool turns = v.at("TE") > 0.0;
      EXPECT_NEAR(bench.state("integral") * VB, turns ? 0.9 * 2.0 + saturated : 2.0, 1e-13);
      const C s(0.0, omega);
      const bool lags = v.at("TA2") + v.at("TA4") > 0.0;
      const C filter =
          (lags ? 1.0 + s * v.at("TA3") : C(1.0)) / ((1.0 + s * v.at("TA2")) * (1.0 + s * v.at("TA4")));
      const C regulator = 3.0 * (1.0 + s * 0.8) / s * filter;
      const C back = s * v.at("KF") / ((1.0 + s * v.at("TF1")) * (1.0 + s * v.at("TF2")));
      const C exciter = turns ? VB / (0.6 * s + 0.9 + slope) : C(VB);
      const C exact = regulator / (1.0 + regulator * back) * exciter;
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - exact),
                1e-7 * (1.0 + std::abs(exact)));
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, &Signals<double>::Efd, omega) +
                         exact * lead_over_lag(0.0, 0.02, omega)),
                1e-7 * (1.0 + std::abs(exact)));
    }
  }
}

TEST(ExciterExpic1, BridgeFollowsVoltageAndRectifierLoading) {
  ControlBench bench("EXPIC1", {{"KC", 0.1}});
  bench.in.V = bench.in.Vr = 0.8;  // the regulated voltage is kept
  const double vr = 2.0 / (6.5 - 0.2 / std::sqrt(3.0));
  EXPECT_NEAR(bench.out().Efd, vr * (0.8 * 6.5 - 0.2 / std::sqrt(3.0)), 1e-12);
}

TEST(ExciterExpic1, IntegralsDoNotWindUp) {
  ControlBench bench("EXPIC1", {{"VR1", 0.8}, {"KC", 0.0}});
  bench.in.dVref = 0.1;
  bench.run(20.0);
  EXPECT_NEAR(bench.out().Efd, 0.8 * 6.5, 1e-6);
  EXPECT_LT(bench.state("integral") + 3.15 * 0.1, 0.8 + 3e-3);
  bench.in.dVref = -0.2;
  bench.run(0.1);
  EXPECT_LT(bench.out().Efd, 0.0);
  bench.run(20.0);
  EXPECT_NEAR(bench.out().Efd, -0.87, 1e-6);  // EFDMIN
}

TEST(ExciterExpic1, RefusesParametersThatCannotBeIntegrated) {
  EXPECT_NE(ControlBench("EXPIC1", {{"EFDMAX", 1.9}}).refused.find("E0 = 2.0"), std::string::npos);
  EXPECT_NE(ControlBench("EXPIC1", {{"VRMAX", 0.1}}).refused.find("Vr = 0.3"), std::string::npos);
  EXPECT_NE(ControlBench("EXPIC1", {{"VR1", 0.1}}).refused.find("PI"), std::string::npos);
  EXPECT_EQ(ControlBench("EXPIC1", {{"KA", 0.0}, {"TA2", -1.0}, {"VR1", -1.0}, {"KC", -1.0}})
                .problems.list()
                .size(),
            4u);
  // Algebraic loop of Vr: one lag in the feedback, none before Vr.
  EXPECT_EQ(ControlBench("EXPIC1", {{"KF", 0.1}, {"TF2", 0.0}, {"TA2", 0.0}}).problems.list().size(), 1u);
  EXPECT_EQ(ControlBench("EXPIC1", {{"KF", 0.1}, {"TF1", 0.0}}).problems.list().size(), 1u);
}

}  // namespace
}  // namespace swingbank::sim::test
