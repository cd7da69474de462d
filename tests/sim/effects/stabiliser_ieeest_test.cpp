// IEEEST: transfer function against the product of its blocks, limits, cut-off by voltage, parameters equal
// to zero.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
constexpr auto kVs = &Signals<double>::Vs;

/// Product of the diagram's blocks at s = j omega.
C diagram(const ControlBench::Changes& v, double omega) {
  const C s(0.0, omega);
  const auto a = [&](const char* n) { return v.contains(n) ? v.at(n) : 0.0; };
  return (1.0 + a("A5") * s + a("A6") * s * s) /
         ((1.0 + a("A1") * s + a("A2") * s * s) * (1.0 + a("A3") * s + a("A4") * s * s)) *
         lead_over_lag(a("T1"), a("T2"), omega) * lead_over_lag(a("T3"), a("T4"), omega) * a("KS") * s *
         a("T5") / (1.0 + s * a("T6"));
}
/// No filter and no cut-off by voltage unless given.
ControlBench::Changes with(ControlBench::Changes more) {
  ControlBench::Changes v = {{"A1", 0.0},  {"A2", 0.0}, {"A3", 0.0},  {"A4", 0.0}, {"VCU", 0.0},
                             {"VCL", 0.0}, {"T1", 0.3}, {"T2", 0.05}, {"T3", 0.2}, {"T4", 0.02},
                             {"T5", 1.5},  {"T6", 2.0}, {"KS", 12.0}};
  for (const auto& [k, x] : more) v[k] = x;
  return v;
}

TEST(StabiliserIeeest, TransferFunctionForEveryOrderOfTheFilter) {
  for (const auto& filter : {ControlBench::Changes{},
                             {{"A1", 0.06}},
                             {{"A1", 0.06}, {"A5", 0.1}},
                             {{"A3", 0.06}, {"A5", 0.1}},
                             {{"A1", 0.06}, {"A2", 0.002}, {"A5", 0.1}, {"A6", 0.004}},
                             {{"A3", 0.06}, {"A4", 0.002}, {"A5", 0.1}, {"A6", 0.004}},
                             {{"A1", 0.06}, {"A3", 0.03}, {"A5", 0.1}, {"A6", 0.004}},
                             {{"A1", 0.06}, {"A2", 0.002}, {"A3", 0.03}, {"A5", 0.1}, {"A6", 0.004}},
                             {{"A1", 0.06}, {"A3", 0.03}, {"A4", 0.001}, {"A6", 0.004}},
                             {{"A1", 0.06}, {"A2", 0.002}, {"A3", 0.03}, {"A4", 0.001}, {"A6", 0.004}}}) {
    const auto values = with(filter);
    for (const auto& [code, input] : {std::pair{1.0, &Signals<double>::speed},
                                      {3.0, &Signals<double>::P},
                                      {4.0, &Signals<double>::Tm},
                                      {5.0, &Signals<double>::V}}) {
      auto all = values;
      all["ICS"] = code;
      ControlBench bench("IEEEST", all);
      EXPECT_TRUE(bench.problems.empty());
      EXPECT_EQ(bench.largest_derivative(), 0.0);
      EXPECT_EQ(bench.out().Vs, 0.0);
      for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
        const C exact = diagram(values, omega);
        // difference quotients with step 1e-6, magnified by up to 1/A2 = 1000
        EXPECT_LT(std::abs(bench.response(input, kVs, omega) - exact), 1e-6 * (1.0 + std::abs(exact)));
      }
    }
  }
}

/// Input codes 2 and 6 measure s/(1 + s Tf) times the angle and the magnitude of the terminal voltage.
TEST(StabiliserIeeest, FrequencyAndVoltageDerivativeAreLagged) {
  const double w0 = 2 * 3.14159265358979323846 * 60, Tf = 0.03;
  for (const double code : {2.0, 6.0}) {
    auto all = with({{"A1", 0.06}, {"Tf", Tf}, {"ICS", code}});
    ControlBench bench("IEEEST", all);
    EXPECT_TRUE(bench.problems.empty());
    EXPECT_EQ(bench.largest_derivative(), 0.0);
    EXPECT_EQ(bench.out().Vs, 0.0);
    for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
      const C s(0.0, omega);
      const C exact = diagram(all, omega) * s / (1.0 + s * Tf) / (code == 2.0 ? w0 : 1.0);
      const auto move = [&](Signals<double>& signal, double d) {
        (code == 2.0 ? signal.Vi : signal.V) += d;  // at V = 1 pu the change of the angle equals that of Vi
      };
      // difference quotients with step 1e-6
      EXPECT_LT(std::abs(bench.response(move, kVs, omega) - exact), 1e-6 * (1.0 + std::abs(exact)));
    }
  }
  EXPECT_EQ(ControlBench("IEEEST", with({{"ICS", 7.0}})).problems.list().size(), 1u);
  EXPECT_EQ(ControlBench("IEEEST", with({{"ICS", 2.5}})).problems.list().size(), 1u);
  EXPECT_EQ(ControlBench("IEEEST", with({{"ICS", 2.0}, {"Tf", 0.0}})).problems.list().size(), 1u);
}

TEST(StabiliserIeeest, ZeroTimeConstantsAreBypassed) {
  ControlBench bench("IEEEST",
                     with({{"T1", 0.0}, {"T2", 0.0}, {"T3", 0.0}, {"T4", 0.0}, {"KS", 4.0}, {"T6", 0.0}}));
  bench.in.speed = 0.002;
  EXPECT_DOUBLE_EQ(bench.out().Vs, 0.008);
}

TEST(StabiliserIeeest, LimitsDoNotWindUpTheWashout) {
  ControlBench bench("IEEEST", with({{"LSMAX", 0.1}, {"LSMIN", -0.05}}));
  bench.in.speed = 0.05;
  bench.run(0.5);
  EXPECT_EQ(bench.out().Vs, 0.1);
  bench.run(40.0);
  EXPECT_NEAR(bench.out().Vs, 0.0, 1e-7);  // washed out: 0.45 pu exp(-40 / 2)
  bench.in.speed = 0.0;
  bench.run(0.5);
  EXPECT_EQ(bench.out().Vs, -0.05);
}

TEST(StabiliserIeeest, VoltageOutsideItsBandCutsTheOutput) {
  ControlBench bench("IEEEST", with({{"VCU", 1.1}, {"VCL", 0.9}}));
  bench.in.speed = 0.001;
  EXPECT_NE(bench.out().Vs, 0.0);
  for (const double v : {1.11, 0.89}) {
    bench.in.Vc = v;
    EXPECT_EQ(bench.out().Vs, 0.0);
  }
  ControlBench off("IEEEST", with({}));
  off.in.speed = 0.001;
  off.in.Vc = 0.1;
  EXPECT_NE(off.out().Vs, 0.0);
}

TEST(StabiliserIeeest, RefusesUnsupportedParametersByName) {
  EXPECT_EQ(ControlBench("IEEEST", {{"ICS", 9.0}, {"IB", 7.0}}).problems.list().size(), 2u);
  EXPECT_EQ(ControlBench("IEEEST", with({{"A6", 0.1}, {"A1", 0.1}})).problems.list().size(), 1u);
}

}  // namespace
}  // namespace swingbank::sim::test
