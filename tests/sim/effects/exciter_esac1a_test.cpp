// ESAC1A: rectifier against its definition, transfer function against the diagram, ceilings and release.
#include "sim/core/blocks.hpp"
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;

/// FEX of IEEE Std 421.5, annex D.
double fex(double in) {
  if (in <= 0.0) return 1.0;
  if (in <= std::sqrt(3.0) / 4.0) return 1.0 - in / std::sqrt(3.0);
  if (in <= 0.75) return std::sqrt(0.75 - in * in);
  return in <= 1.0 ? std::sqrt(3.0) * (1.0 - in) : 0.0;
}

TEST(Rectifier, IsFexAndItsInverse) {
  for (const double v : {0.5, 2.0, 5.0})
    for (double in = -0.2; in < 1.2; in += 0.01) {
      EXPECT_NEAR(rectified(v, in * v), v * fex(in), 1e-14) << in;  // rounding
      if (fex(in) > 0.0) {
        EXPECT_NEAR(rectifier_source(v * fex(in), in * v), v, 1e-13) << in;
      }
    }
}

TEST(ExciterEsac1a, TransferFunctionIsTheDiagrams) {
  // unsaturated, unloaded rectifier: linear
  const ControlBench::Changes linear = {{"TR", 0.02}, {"TB", 0.1},  {"TC", 0.3}, {"KA", 150.0}, {"TA", 0.05},
                                        {"TE", 0.9},  {"KF", 0.04}, {"TF", 0.8}, {"KC", 0.0},   {"KD", 0.0},
                                        {"KE", 1.1},  {"SE1", 0.0}, {"SE2", 0.0}};
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("ESAC1A", linear);
    ASSERT_TRUE(bench.problems.empty());
    ASSERT_EQ(bench.refused, "");
    EXPECT_LT(bench.largest_derivative(), 1e-11);  // rounding times KA/TA
    EXPECT_DOUBLE_EQ(bench.out().Efd, 2.0);
    const C s(0.0, omega);
    const C forward =
        150.0 * lead_over_lag(0.3, 0.1, omega) * lead_over_lag(0.0, 0.05, omega) / (1.1 + 0.9 * s);
    const C closed = forward / (1.0 + forward * 1.1 * 0.04 * s / (1.0 + 0.8 * s));
    // difference quotients with step 1e-6, amplified by KA/TA = 3000
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - closed), 1e-5);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, &Signals<double>::Efd, omega) +
                       closed * lead_over_lag(0.0, 0.02, omega)),
              1e-5);
  }
}

TEST(ExciterEsac1a, StartsInEveryModeOfTheRectifier) {
  for (const double kc : {0.0, 0.2, 0.8, 2.5}) {  // IN = 0, 0.18, 0.54, 0.81
    ControlBench bench("ESAC1A", {{"KC", kc}, {"VRMAX", 30.0}, {"VAMAX", 40.0}});
    EXPECT_EQ(bench.refused, "");
    EXPECT_NEAR(bench.out().Efd, 2.0, 1e-14);
    EXPECT_LT(bench.largest_derivative(), 1e-10) << kc;
    EXPECT_NEAR(bench.state("Ve") * fex(kc * 2.0 / bench.state("Ve")), 2.0, 1e-14);
  }
}

TEST(ExciterEsac1a, CeilingIsWhereTheFieldBalancesVrmaxAndReleaseIsImmediate) {
  ControlBench bench("ESAC1A", {{"KC", 0.1}});
  bench.in.dVref = 0.5;
  bench.run(20.0);  // 25 TE
  EXPECT_EQ(bench.state("Va"), 14.5);
  const double ve = bench.state("Ve");
  // through (3.14, 0.03) and (4.18, 0.1): sqrt(V Se) is linear in V
  const double low = std::sqrt(3.14 * 0.03), high = std::sqrt(4.18 * 0.1);
  const double saturation = std::pow(low + (high - low) * (ve - 3.14) / (4.18 - 3.14), 2);
  EXPECT_NEAR(ve + saturation + 0.38 * 2.0, 6.03, 1e-8);
  EXPECT_NEAR(bench.out().Efd, ve - 0.1 * 2.0 / std::sqrt(3.0), 1e-14);
  // reference lowered: Va leaves its limit of 14.5 pu without delay, as the output of a lag
  bench.in.dVref = -0.5;
  bench.run(0.01);
  EXPECT_LT(bench.state("Va"), 14.5);
  bench.run(20.0);
  EXPECT_EQ(bench.state("Ve"), 0.0);  // the rectifier does not reverse
  EXPECT_EQ(bench.out().Efd, 0.0);
  bench.in.dVref = 0.5;
  bench.run(0.3);
  EXPECT_GT(bench.state("Ve"), 1.0);  // about (6.03 - 0.76) x 0.3/0.8 pu, less because of Va's delay
}

TEST(ExciterEsac1a, RefusesOperatingPointBeyondItsLimits) {
  auto reversed = ControlBench::rated();
  reversed.Efd = -0.1;
  EXPECT_NE(ControlBench("ESAC1A", {}, reversed).refused.find("Efd = -0.1000 pu"), std::string::npos);
  EXPECT_NE(ControlBench("ESAC1A", {{"VRMAX", 1.0}}).refused.find("VRMAX"), std::string::npos);
  EXPECT_EQ(ControlBench("ESAC1A", {{"TE", 0.0}, {"TF", 0.0}, {"KC", -0.1}}).problems.list().size(), 3u);
}

}  // namespace
}  // namespace swingbank::sim::test
