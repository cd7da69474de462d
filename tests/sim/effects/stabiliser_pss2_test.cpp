// PSS2B and PSS2A: transfer functions from both inputs against the product of their blocks, order of the
// ramp-tracking filter, rejection of power ramps, limits, parameters equal to zero.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;
constexpr auto kOutput = &Signals<double>::Vs;

double value(const Values& v, const char* name) { return v.contains(name) ? v.at(name) : 0.0; }
/// s T/(1 + s T), or 1 for T = 0.
C washout_factor(double T, double omega) {
  const C s(0.0, omega);
  return T > 0.0 ? s * T / (1.0 + s * T) : C(1.0);
}
C first(const Values& v, double omega) {
  return washout_factor(value(v, "Tw1"), omega) * washout_factor(value(v, "Tw2"), omega) *
         lead_over_lag(0.0, value(v, "T6"), omega);
}
C second(const Values& v, double omega) {
  return value(v, "KS2") * washout_factor(value(v, "Tw3"), omega) * washout_factor(value(v, "Tw4"), omega) *
         lead_over_lag(0.0, value(v, "T7"), omega);
}
C ramp_tracking(const Values& v, double omega) {
  const C s(0.0, omega);
  const C stage = (1.0 + s * value(v, "T8")) / std::pow(1.0 + s * value(v, "T9"), value(v, "M"));
  return value(v, "M") > 0.0 ? std::pow(stage, value(v, "N")) : C(1.0);
}
C behind(const Values& v, double omega) {
  return value(v, "KS1") * lead_over_lag(value(v, "T1"), value(v, "T2"), omega) *
         lead_over_lag(value(v, "T3"), value(v, "T4"), omega) *
         lead_over_lag(value(v, "T10"), value(v, "T11"), omega);
}
/// Values of the parameters that both stabilisers have, all different. PSS2B also has a third lead-lag.
Values common(Values more) {
  Values v = {{"Tw1", 2.1}, {"Tw2", 3.3}, {"T6", 0.03}, {"Tw3", 2.7}, {"Tw4", 1.9}, {"T7", 2.3},
              {"KS2", 0.3}, {"KS3", 0.9}, {"T8", 0.4},  {"T9", 0.11}, {"KS1", 7.0}, {"T1", 0.2},
              {"T2", 0.03}, {"T3", 0.15}, {"T4", 0.04}, {"M", 5.0},   {"N", 1.0}};
  for (const auto& [k, x] : more) v[k] = x;
  return v;
}
Values third(Values v) {
  v["T10"] = 0.3;
  v["T11"] = 0.05;
  return v;
}

void expect_diagram(const char* name, Values v, double omega) {
  v["VSTMAX"] =
      1e3;  // eight leads of T8/T9 amplify the step of the difference quotient beyond ordinary limits
  v["VSTMIN"] = -1e3;
  ControlBench bench(name, v);
  EXPECT_TRUE(bench.problems.empty());
  EXPECT_EQ(bench.refused, "");
  EXPECT_EQ(bench.largest_derivative(), 0.0);
  EXPECT_EQ(bench.out().Vs, 0.0);
  const C one = first(v, omega) * ramp_tracking(v, omega) * behind(v, omega);
  const C two = second(v, omega) * (value(v, "KS3") * ramp_tracking(v, omega) - 1.0) * behind(v, omega);
  // difference quotients with step 1e-6, magnified by the leads' T1 T3 T10/(T2 T4 T11) = 150
  EXPECT_LT(std::abs(bench.response(&Signals<double>::speed, kOutput, omega) - one),
            1e-6 * (1 + std::abs(one)))
      << name << " at " << omega;
  EXPECT_LT(std::abs(bench.response(&Signals<double>::P, kOutput, omega) - two), 1e-6 * (1 + std::abs(two)))
      << name << " at " << omega;
}

TEST(StabiliserPss2, TransferFunctionsFromBothInputsAreTheDiagrams) {
  for (const auto& more : {Values{},
                           {{"M", 2.0}, {"N", 4.0}},
                           {{"M", 1.0}, {"N", 1.0}},
                           {{"M", 1.0}, {"N", 8.0}},
                           {{"M", 4.0}, {"N", 2.0}},
                           {{"M", 8.0}, {"N", 1.0}},
                           {{"M", 0.0}, {"N", 3.0}},
                           {{"M", 3.0}, {"N", 0.0}},
                           {{"Tw2", 0.0}, {"Tw4", 0.0}},
                           {{"T6", 0.0}, {"T7", 0.0}}})
    for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
      expect_diagram("PSS2A", common(more), omega);
      expect_diagram("PSS2B", third(common(more)), omega);
    }
}

TEST(StabiliserPss2, EveryCodeReadsItsSignal) {
  for (const char* code : {"IC1", "IC2"})
    for (const auto& [number, input] : {std::pair{1.0, &Signals<double>::speed},
                                        {3.0, &Signals<double>::P},
                                        {4.0, &Signals<double>::Tm},
                                        {5.0, &Signals<double>::V}}) {
      // both inputs use this signal; only one of the two paths is active
      Values v = third(common({{"IC1", number}, {"IC2", number}}));
      if (code[2] == '1') v["KS2"] = 0.0;
      v[code[2] == '1' ? "IC2" : "IC1"] = number == 1.0 ? 5.0 : 1.0;
      const C exact = (code[2] == '1' ? first(v, 7.0) * ramp_tracking(v, 7.0)
                                      : second(v, 7.0) * (0.9 * ramp_tracking(v, 7.0) - 1.0)) *
                      behind(v, 7.0);
      ControlBench bench("PSS2B", v);
      EXPECT_LT(std::abs(bench.response(input, kOutput, 7.0) - exact), 1e-6 * (1.0 + std::abs(exact)))
          << code << " = " << number;
    }
}

/// Purpose of the ramp-tracking filter: with T8 = M T9 and KS3 = 1 a ramp of mechanical power at constant
/// speed does not change Vs; with T8 = 0 it does.
TEST(StabiliserPss2, RampOfPowerIsTrackedBySecondOrder) {
  const auto after_a_ramp = [](double T8) {
    auto v = common({{"KS3", 1.0}, {"T8", T8}, {"T9", 0.1}, {"Tw3", 100.0}, {"Tw4", 0.0}, {"T7", 50.0}});
    v["VSTMAX"] = 10.0;
    v["VSTMIN"] = -10.0;
    ControlBench bench("PSS2A", v);
    for (int i = 0; i < 400; ++i) {  // 0.001 pu each 10 ms for 4 s, long against M T9
      bench.in.P += 0.001;
      bench.run(0.01, 0.005);
    }
    return std::abs(bench.out().Vs);
  };
  // without lead the filter lags by M T9 = 0.5 s behind the integral of a ramp
  EXPECT_LT(after_a_ramp(0.5), 0.1 * after_a_ramp(0.0));
}

TEST(StabiliserPss2, InputAndOutputLimitsActAndRelease) {
  auto v = third(common({{"VS1MAX", 0.01}, {"VS1MIN", -0.02}, {"VSTMAX", 0.06}, {"VSTMIN", -0.05}}));
  ControlBench bench("PSS2B", v), at_limit("PSS2B", v);
  bench.in.speed = 0.5;
  at_limit.in.speed = 0.01;
  bench.run(0.3);
  at_limit.run(0.3);
  EXPECT_EQ(bench.out().Vs, at_limit.out().Vs);  // inputs are clamped at their limits
  EXPECT_EQ(bench.out().Vs, 0.06);
  bench.run(60.0);
  EXPECT_NEAR(bench.out().Vs, 0.0, 1e-6);  // washed out: 0.07 pu exp(-60 / 3.3)
  bench.in.speed = 0.0;
  bench.run(0.3);
  EXPECT_EQ(bench.out().Vs,
            -0.05);  // released without delay: the step of -0.01 pu passes through the washout
}

TEST(StabiliserPss2, RefusesUnsupportedParameters) {
  EXPECT_EQ(ControlBench("PSS2A",
                         {{"IC1", 2.0}, {"IC2", 5.0}, {"REMBUS2", 7.0}, {"M", 5.0}, {"N", 2.0}, {"Tw1", 0.0}})
                .problems.list()
                .size(),
            4u);
  EXPECT_EQ(ControlBench("PSS2B", {{"M", 1.5}, {"T9", 0.0}, {"VS2MAX", 0.0}, {"VS2MIN", 0.0}})
                .problems.list()
                .size(),
            3u);
  // 0.8 pu of power
  EXPECT_NE(ControlBench("PSS2B", {{"VS2MAX", 0.7}}).refused.find("0.8000 pu"), std::string::npos);
}

TEST(StabiliserPss2, Pss2cAddsAFourthLeadLag) {
  for (const double omega : {0.3, 5.0}) {
    Values v = third(common({{"VSTMAX", 1e3}, {"VSTMIN", -1e3}}));
    ControlBench before("PSS2B", v);
    v["T12"] = 0.2;
    v["T13"] = 0.06;
    ControlBench bench("PSS2C", v);
    EXPECT_TRUE(bench.problems.empty());
    EXPECT_EQ(bench.largest_derivative(), 0.0);
    const C one = before.response(&Signals<double>::speed, kOutput, omega) * lead_over_lag(0.2, 0.06, omega);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::speed, kOutput, omega) - one),
              1e-5 * (1 + std::abs(one)));
  }
}

TEST(StabiliserPss2, Pss2cIsSwitchedByThePower) {
  ControlBench bench("PSS2C", {{"IC2", 5.0}, {"PSSON", 0.5}, {"PSSOFF", 0.3}});
  bench.in.speed = 0.01;
  bench.run(0.1);
  const double whole = bench.out().Vs;
  EXPECT_GT(whole, 0.01);
  bench.in.speed = 0.0;
  for (const auto& [P, part] : {std::pair{0.4, 1.0}, {0.2, 0.0}, {0.4, 0.0}, {0.6, 1.0}, {0.4, 1.0}}) {
    bench.in.P = P;
    bench.run(0.1);
    EXPECT_NEAR(bench.x.back(), part, 1e-6) << P;
  }
  EXPECT_FALSE(ControlBench("PSS2C", {{"PSSOFF", 0.1}}).problems.empty());
}

}  // namespace
}  // namespace swingbank::sim::test
