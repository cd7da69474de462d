// EXAC2 and ESAC6A: transfer functions against their diagrams, gates and limits.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
// Without saturation and commutation: Efd = Ve, Vfe = KE Ve + KD Ifd.
const ControlBench::Changes kExac2 = {{"TR", 0.02}, {"TB", 2.0}, {"TC", 0.5}, {"KA", 200.0}, {"TA", 0.05},
                                      {"KB", 5.0},  {"TE", 0.8}, {"KL", 3.0}, {"KH", 0.4},   {"KF", 0.03},
                                      {"TF", 1.1},  {"KC", 0.0}, {"KD", 0.3}, {"KE", 0.9},   {"VLR", 15.0},
                                      {"SE1", 0.0}, {"SE2", 0.0}};

TEST(ExciterAcTypes, Exac2ClosesItsInnerLoop) {
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("EXAC2", kExac2);
    ASSERT_TRUE(bench.problems.empty());
    ASSERT_EQ(bench.refused, "");
    EXPECT_LT(bench.largest_derivative(), 1e-10);
    const C s(0.0, omega);
    // Va to Vfe: TE s Ve = KB (Va - KH Vfe) - Vfe, Vfe = KE Ve
    const C inner = 5.0 / (1.0 + 5.0 * 0.4 + 0.8 * s / 0.9);
    const C regulator = 200.0 * lead_over_lag(0.5, 2.0, omega) * lead_over_lag(0.0, 0.05, omega);
    const C forward = regulator * inner,
            closed = forward / (1.0 + forward * 0.03 * s / (1.0 + 1.1 * s)) / 0.9;
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - closed), 1e-5);
  }
}

TEST(ExciterAcTypes, Exac2CeilingIsWhereItsLimiterBalancesTheField) {
  auto values = kExac2;
  values["VLR"] = 5.0;
  ControlBench bench("EXAC2", values);
  ASSERT_EQ(bench.refused, "");
  bench.in.dVref = 1.0;
  bench.run(20.0);
  // KB KL (VLR - Vfe) = Vfe, Vfe = KE Efd + KD Ifd
  const double Vfe = 15.0 * 5.0 / 16.0;
  EXPECT_NEAR(bench.out().Efd, (Vfe - 0.3 * 2.0) / 0.9, 1e-9);
  EXPECT_NE(ControlBench("EXAC2", {{"VLR", 1.0}}).refused.find("limiter"), std::string::npos);
  EXPECT_FALSE(ControlBench("EXAC2", {{"KL", 0.0}}).problems.empty());
}

const ControlBench::Changes kEsac6a = {{"TR", 0.02}, {"KA", 300.0}, {"TA", 0.1},  {"TK", 0.2},
                                       {"TB", 6.0},  {"TC", 2.0},   {"TE", 0.9},  {"KC", 0.0},
                                       {"KD", 0.3},  {"KE", 1.2},   {"SE1", 0.0}, {"SE2", 0.0}};

TEST(ExciterAcTypes, Esac6aTransferFunctionIsTheDiagrams) {
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("ESAC6A", kEsac6a);
    ASSERT_TRUE(bench.problems.empty());
    ASSERT_EQ(bench.refused, "");
    EXPECT_LT(bench.largest_derivative(), 1e-10);
    const C s(0.0, omega);
    const C exact = 300.0 * lead_over_lag(0.2, 0.1, omega) * lead_over_lag(2.0, 6.0, omega) / (1.2 + 0.9 * s);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - exact), 1e-4);
  }
}

TEST(ExciterAcTypes, Esac6aFieldLimiterActsWithinItsBounds) {
  auto values = kEsac6a;
  values["VFELIM"] = 8.0;
  values["KH"] = 10.0;
  values["VHMAX"] = 75.0;
  values["VAMAX"] = 30.0;
  ControlBench bench("ESAC6A", values);
  bench.in.dVref = 1.0;
  bench.run(30.0);
  // VAMAX - KH (Vfe - VFELIM) = Vfe
  const double Vfe = (30.0 + 80.0) / 11.0;
  EXPECT_NEAR(bench.out().Efd, (Vfe - 0.3 * 2.0) / 1.2, 1e-6);
}

TEST(ExciterAcTypes, Esac6aLimitsFollowTheVoltageAndReleaseWithoutDelay) {
  auto values = kEsac6a;
  values["KH"] = 0.0;
  values["VRMAX"] = 20.0;
  ControlBench bench("ESAC6A", values);
  bench.in.dVref = 1.0;
  bench.in.V = 0.5;
  bench.run(30.0);
  EXPECT_NEAR(bench.out().Efd, (0.5 * 20.0 - 0.3 * 2.0) / 1.2, 1e-6);
  EXPECT_NEAR(bench.state("second"), 75.0, 1e-4);  // at the limit of its output, not at 300
  bench.in.dVref = -1.0;
  bench.in.V = 1.0;
  bench.run(0.5);
  EXPECT_LT(bench.out().Efd, (0.5 * 20.0 - 0.3 * 2.0) / 1.2);
}

}  // namespace
}  // namespace swingbank::sim::test
