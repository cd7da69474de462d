// SCRX: transfer function, both feeds, limits, negative field current.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

const ControlBench::Changes kScrx = {{"TAoverTB", 0.2}, {"TB", 2.0},    {"K", 80.0},
                                     {"TE", 0.05},      {"EMIN", -3.0}, {"EMAX", 4.0}};

TEST(ExciterScrx, TransferFunctionIsTheDiagrams) {
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("SCRX", kScrx);
    ASSERT_TRUE(bench.problems.empty());
    const auto exact = 80.0 * lead_over_lag(0.4, 2.0, omega) * lead_over_lag(0.0, 0.05, omega);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - exact), 1e-6);
  }
}

TEST(ExciterScrx, OnlyTheBusFedOneFollowsTheVoltage) {
  for (const double solid : {0.0, 1.0}) {
    auto values = kScrx;
    values["CSWITCH"] = solid;
    auto at = ControlBench::rated();
    at.V = at.Vc = 0.8;
    ControlBench bench("SCRX", values, at);
    EXPECT_DOUBLE_EQ(bench.out().Efd, 2.0);
    EXPECT_DOUBLE_EQ(bench.state("E"), solid == 1.0 ? 2.0 : 2.5);
    bench.in.dVref = 1.0;
    bench.run(20.0);
    EXPECT_DOUBLE_EQ(bench.out().Efd, solid == 1.0 ? 4.0 : 0.8 * 4.0);
  }
}

TEST(ExciterScrx, NegativeFieldCurrentFlowsThroughTheCrowbarOrTheBridge) {
  for (const double ratio : {0.0, 7.0}) {
    auto values = kScrx;
    values["rcrfd"] = ratio;
    ControlBench bench("SCRX", values);
    bench.in.Ifd = -0.5;
    EXPECT_DOUBLE_EQ(bench.out().Efd, ratio == 0.0 ? 2.0 : 3.5);
  }
  auto at = ControlBench::rated();
  at.Ifd = -0.1;
  EXPECT_NE(ControlBench("SCRX", {{"rcrfd", 5.0}}, at).refused.find("negative"), std::string::npos);
}

TEST(ExciterScrx, RefusesParametersThatCannotBeIntegrated) {
  using Change = std::pair<const char*, double>;
  for (const auto& [name, value] :
       {Change{"K", 0.0}, {"TE", -1.0}, {"CSWITCH", 2.0}, {"rcrfd", -1.0}, {"EMIN", 9.0}})
    EXPECT_FALSE(ControlBench("SCRX", {{name, value}}).problems.empty()) << name;
}

}  // namespace
}  // namespace swingbank::sim::test
