// Current and voltage transformers, and the skew between channels, against hand calculations.
#include "tests/sim/effects/measurement_bench.hpp"

namespace swingbank::sim::effects {
namespace {

using test::kPi;
using test::measured;
using test::swing;

TEST(CurrentTransformer, ScalesAndRotatesTheCurrentOnly) {
  const Phasors before = swing(60.0), after = measured("CTERROR", {0.01, 0.02}, before);
  for (std::size_t k = 0; k < before.V.size(); ++k) {
    EXPECT_EQ(after.V[k], before.V[k]);
    EXPECT_NEAR(std::abs(after.I[k]) / std::abs(before.I[k]), 1.01, 1e-14);  // rounding
    EXPECT_NEAR(std::arg(after.I[k] * std::conj(before.I[k])), 0.02, 1e-14);
  }
  // S = V I*: with P = 1 and Q = 0, a current that leads by 0.02 rad and is 1 % too large gives Q = -1.01
  // sin(0.02).
  Phasors one{60.0, 60.0, {1.0}, {1.0}, {0.0}};
  one = measured("CTERROR", {0.01, 0.02}, one);
  EXPECT_NEAR(std::imag(one.V[0] * std::conj(one.I[0])), -0.020198653360, 1e-12);
}

TEST(VoltageTransformer, ScalesAndRotatesTheVoltageOnly) {
  const Phasors before = swing(60.0), after = measured("PTERROR", {-0.02, 0.01}, before);
  for (std::size_t k = 0; k < before.V.size(); ++k) {
    EXPECT_EQ(after.I[k], before.I[k]);
    EXPECT_NEAR(std::abs(after.V[k]) / std::abs(before.V[k]), 0.98, 1e-14);
    EXPECT_NEAR(std::arg(after.V[k] * std::conj(before.V[k])), 0.01, 1e-14);
    EXPECT_EQ(after.df[k], before.df[k]);  // a constant phase shift does not change the frequency
  }
}

TEST(Skew, ShiftsThePhaseOfASine) {
  const double rate = 60.0, slip = 2 * kPi * 1.0;
  Phasors before{rate, 60.0, {}, {}, {}};
  for (int k = 0; k < 300; ++k) {
    before.V.emplace_back(1.0);
    before.I.push_back(std::polar(1.0, slip * k / rate));
    before.df.push_back(0.0);
  }
  for (const double skew : {0.0073, -0.0041, 0.25, 1.0 / 60}) {
    const Phasors after = measured("SKEW", {skew}, before);
    for (std::size_t k = 20; k < 280; ++k) {
      EXPECT_EQ(after.V[k], before.V[k]);
      const auto expected = before.I[k] * std::polar(1.0, -slip * skew);
      // a cubic through samples 0.105 rad apart: at most 0.016 x 0.105^3 = 2e-5 off
      EXPECT_LT(std::abs(after.I[k] - expected), 2e-5) << skew << " s";
    }
  }
}

TEST(Skew, OfAStepInterpolatesOneSample) {
  Phasors before{60.0, 60.0, {}, {}, {}};
  for (int k = 0; k < 40; ++k) {
    before.V.emplace_back(1.0);
    before.I.emplace_back(k <= 10 ? 1.0 + 0.001 * k : 3.0 - 0.002 * k);
    before.df.push_back(0.0);
  }
  const Phasors after = measured("SKEW", {2.25 / 60}, before);
  for (std::size_t k = 3; k < 40; ++k) {
    const double at = static_cast<double>(k) - 2.25;
    const double left = 1.0 + 0.001 * 10, right = 3.0 - 0.002 * 11;
    const double expected =
        at <= 10 ? 1.0 + 0.001 * at : (at >= 11 ? 3.0 - 0.002 * at : left + (at - 10) * (right - left));
    EXPECT_NEAR(after.I[k].real(), expected, 1e-13) << k;  // exact for linear segments
  }
}

TEST(Skew, ExtrapolatesAConstantCurrent) {
  const Phasors before = swing(60.0), after = measured("SKEW", {0.5}, before);
  for (std::size_t k = 0; k <= 30; ++k) EXPECT_EQ(after.I[k], before.I[0]) << k;
  const Phasors early = measured("SKEW", {-100.0}, before);  // longer than the record
  EXPECT_EQ(early.I[0], before.I.back());
}

}  // namespace
}  // namespace swingbank::sim::effects
