// Windows of class P and M and the resulting frequency, against hand-calculated formulas.
#include "tests/sim/effects/measurement_bench.hpp"

namespace swingbank::sim::effects {
namespace {

using test::kPi;
using test::measured;

/// Phasor that rotates at `hz` relative to the synchronous frame.
Phasors turning(double rate, double hz, double seconds = 3.0) {
  Phasors p{rate, 60.0, {}, {}, {}};
  for (int k = 0; k <= static_cast<int>(seconds * rate); ++k) {
    p.V.push_back(std::polar(1.0, 2 * kPi * hz * k / rate));
    p.I.push_back(std::polar(0.5, 2 * kPi * hz * k / rate - 0.3));
    p.df.push_back(hz / 60.0);
  }
  return p;
}

/// Gain of the filter at an offset from nominal frequency, from the middle of the record.
std::complex<double> gain(double rate, double hz, const std::vector<double>& p) {
  const Phasors before = turning(rate, hz), after = measured("PMUFILTER", p, before);
  const std::size_t k = before.V.size() / 2;
  EXPECT_LT(std::abs(after.V[k] / before.V[k] - after.I[k] / before.I[k]), 1e-13);  // V and I alike
  const std::complex<double> ratio = after.V[k] / before.V[k];
  // rounding; near zero gain the angle is rounding only
  if (std::abs(ratio) > 0.05) {
    EXPECT_NEAR(after.df[k], hz / 60.0, 1e-12);
  }
  return ratio;
}

double sinc(double x) { return x == 0.0 ? 1.0 : std::sin(x) / x; }

constexpr double kClassP = 0.0, kClassM = 1.0;

TEST(PmuFilterP, TwoCycleTriangleHasASquaredSincResponse) {
  // (sin(pi/12) / (pi/12))^2 = (0.2588190 / 0.2617994)^2
  EXPECT_NEAR(gain(960.0, 5.0, {kClassP, 1, 60, 0}).real(), 0.9773613, 1e-6);
  for (const double hz : {0.5, 2.0, 10.0, 30.0}) {
    const double x = kPi * hz / 60.0, phase = 2 * kPi * hz / 960.0;
    const auto g = gain(960.0, hz, {kClassP, 1, 60, 0});
    // The cubic through samples `phase` [rad] apart reduces the gain by at most phase^4 / 80. The window is
    // even, so it does not shift the phase.
    EXPECT_NEAR(g.real(), sinc(x) * sinc(x), std::pow(phase, 4) / 80 + 1e-9) << hz << " Hz";
    EXPECT_NEAR(g.imag(), 0.0, 1e-13) << hz << " Hz";
  }
  EXPECT_NEAR(gain(960.0, 60.0, {kClassP, 1, 60, 0}).real(), 0.0, 2e-3);  // zero one f0 away, phase^4 / 80
  EXPECT_NEAR(gain(960.0, 5.0, {kClassP, 2, 60, 0}).real(), std::pow(sinc(kPi / 6), 2), 1e-6);
}

TEST(PmuFilterP, CompensationRestoresTheMagnitude) {
  // sinc^2 divided by cos(1.625 pi hz / 120), from the two formulas; class P is specified for +-2 Hz.
  for (const double hz : {-2.0, -1.0, 0.5, 2.0}) {
    const double x = kPi * hz / 60.0;
    const double g = gain(960.0, hz, {kClassP, 1, 60, 1}).real();
    EXPECT_NEAR(g, sinc(x) * sinc(x) / std::cos(1.625 * x / 2), 1e-7) << hz;
    EXPECT_NEAR(g, 1.0, 5e-5) << hz;
  }
}

TEST(PmuFilterP, AStepTakesTwoCycles) {
  const double rate = 960.0;
  Phasors before{rate, 60.0, {}, {}, {}};
  const int at = 480;  // the step lies between this sample and the next
  for (int k = 0; k < 960; ++k) {
    before.V.emplace_back(k <= at ? 1.0 : 0.5);
    before.I.emplace_back(k <= at ? 1.0 : 3.0);
    before.df.push_back(0.0);
  }
  const Phasors after = measured("PMUFILTER", {kClassP, 1, 60, 1}, before);
  const auto moved = [&](double seconds) {  // measured fraction of the step, by time since its middle
    const double k = at + 0.5 + seconds * rate;
    const auto low = static_cast<std::size_t>(std::floor(k));
    const double u = k - std::floor(k);
    return (1 - u) * (after.I[low].real() - 1.0) / 2 + u * (after.I[low + 1].real() - 1.0) / 2;
  };
  const double cycle = 1.0 / 60.0, slack = 2.0 / rate;
  EXPECT_EQ(after.df[at], 0.0);
  EXPECT_NEAR(moved(-cycle - slack), 0.0, 1e-14);
  EXPECT_NEAR(moved(cycle + slack), 1.0, 1e-14);
  EXPECT_NEAR(moved(0.0), 0.5, 1e-12);
  // 1/2 + u - u^2/2 of the triangle, u in cycles; a step is a ramp of one sample: u^2 / 24 of 1/16 = 2e-4
  EXPECT_NEAR(moved(0.5 * cycle), 0.875, 4e-4);
  EXPECT_NEAR(moved(-0.5 * cycle), 0.125, 4e-4);
}

TEST(PmuFilterM, EqualsTheStandardsWindow) {
  struct Row {
    double reports, Ffr;
    int order;
  };
  // Taps of the standard at 960 samples per second, and their gain at a frequency offset.
  for (const Row row : {Row{60, 8.19, 164}, Row{30, 5.02, 306}, Row{120, 16.25, 70}, Row{10, 1.78, 968}})
    for (const double share : {0.1, 0.5, 1.0, 2.0, 2.5}) {
      const double hz = share * row.Ffr;
      double sum = 0.0, of = 0.0;
      for (int k = -row.order / 2; k <= row.order / 2; ++k) {
        const double x = 2 * kPi * 2 * row.Ffr / 960.0 * k;
        const double tap = sinc(x) * (0.54 + 0.46 * std::cos(2 * kPi * k / row.order));
        sum += tap;
        of += tap * std::cos(2 * kPi * hz * k / 960.0);
      }
      // The filter's integral gives the two end taps half weight, the standard's sum full weight. The end
      // taps are largest with 120 reports/s: 0.08 x 0.12 = 0.0098 each, while all taps sum to 15. Two taps,
      // each in the average and in its divisor, give 2 x 2 x 0.5 x 0.0098 / 15 = 1.3e-3.
      EXPECT_NEAR(gain(960.0, hz, {kClassM, 1, row.reports, 1}).real(), of / sum, 1.5e-3)
          << row.reports << " reports, " << hz << " Hz";
    }
}

TEST(PmuFilterM, HalvesAtTwiceTheReferenceFrequency) {
  EXPECT_NEAR(gain(960.0, 2 * 8.19, {kClassM, 1, 60, 1}).real(), 0.5, 5e-3);  // -6 dB of any windowed sinc
  // Out of the band of 60 reports per second: below -46 dB, a Hamming window's side lobes lie at -53 dB.
  for (const double hz : {30.0, 37.0, 45.0, 60.0})
    EXPECT_LT(std::abs(gain(960.0, hz, {kClassM, 1, 60, 1})), 5e-3) << hz;
  EXPECT_NEAR(gain(960.0, 1.0, {kClassM, 1, 60, 1}).real(), 1.0, 2e-3);
}

TEST(PmuFilterM, ReportsRatesWithoutAStandardWindow) {
  EXPECT_THROW(measured("PMUFILTER", {kClassM, 1, 25, 1}, turning(60.0, 0.0)), InputError);
  Phasors fifty = turning(50.0, 0.0);
  fifty.frequency = 50.0;
  EXPECT_NO_THROW(measured("PMUFILTER", {kClassM, 1, 25, 1}, fifty));
  Problems problems;
  const std::vector<double> p = {kClassM, 1, 61, 1};
  test::effect("PMUFILTER").check(nullptr, p.data(), "test", problems);
  EXPECT_EQ(problems.list().size(), 1u);
}

TEST(PmuFilter, MissingSampleInvalidatesAWindow) {
  Phasors before = turning(240.0, 0.5);
  before.V[300] = std::numeric_limits<double>::quiet_NaN();
  const Phasors after = measured("PMUFILTER", {kClassP, 1, 60, 1}, before);
  EXPECT_TRUE(std::isnan(std::abs(after.V[300])) && std::isnan(std::abs(after.V[303])));
  EXPECT_FALSE(std::isnan(std::abs(after.V[308])) || std::isnan(after.df[308]));
}

/// Angle A sin(W t), whose frequency is known in closed form.
Phasors wavering(double rate, double A, double W) {
  Phasors p{rate, 60.0, {}, {}, {}};
  for (int k = 0; k <= static_cast<int>(5 * rate); ++k) {
    p.V.push_back(std::polar(0.97, A * std::sin(W * k / rate) + 2 * kPi * 3.0 * k / rate));
    p.I.emplace_back(1.0);
    p.df.push_back(0.0);
  }
  return p;
}

TEST(PmuFrequency, DifferenceAndAverageOfASine) {
  const double rate = 120.0, A = 0.4, W = 2 * kPi * 0.8, span = 0.1, smoothing = 0.3;
  const Phasors before = wavering(rate, A, W);
  const Phasors difference = measured("PMUFREQ", {span, 0.0}, before);
  const Phasors both = measured("PMUFREQ", {span, smoothing}, before);
  for (std::size_t k = 60; k < before.V.size() - 60; ++k) {
    const double deviation = A * W * std::cos(W * static_cast<double>(k) / rate) / (2 * kPi * 60.0);
    // A sine stays a sine: the difference reduces it by sinc(W span / 2), the average by sinc(W smoothing /
    // 2). 3 Hz are 0.05 pu. The cubic through samples 0.042 rad apart errs by 1e-6 A at each end of the span,
    // which gives 2e-6 x 0.4 / (0.1 x 2 pi x 60).
    EXPECT_NEAR(difference.df[k], 0.05 + deviation * sinc(W * span / 2), 1e-7);
    EXPECT_NEAR(both.df[k], 0.05 + deviation * sinc(W * span / 2) * sinc(W * smoothing / 2), 1e-6);
    EXPECT_EQ(both.V[k], before.V[k]);
  }
}

TEST(PmuFrequency, EndsUseTheAvailableSamples) {
  Phasors before = wavering(120.0, 0.0, 1.0);
  const Phasors after = measured("PMUFREQ", {0.5, 0.0}, before);
  for (const double df : after.df) EXPECT_NEAR(df, 0.05, 1e-12);  // a steady 3 Hz up to the last sample
}

/// A first-order lag has gain 1 / sqrt(1 + (W T)^2) and phase -atan(W T) for a sine.
TEST(FrequencyLag, FiltersASine) {
  constexpr double kRate = 240.0, kW = 2 * kPi * 1.1, kLag = 0.08, kSettled = 20 * kLag;
  const Phasors before = swing(kRate);
  const Phasors after = measured("FREQLAG", {kLag}, before);
  const double gain = 1 / std::hypot(1.0, kW * kLag), phase = std::atan(kW * kLag);
  for (std::size_t k = 0; k < after.df.size(); ++k) {
    const double t = static_cast<double>(k) / kRate;
    // The chords of a sine of period 218 samples are (2 pi / 218)^2 / 12 = 7e-5 of it too small.
    if (t > kSettled) {
      EXPECT_NEAR(after.df[k], gain * 0.3 * kW * std::cos(kW * t - phase) / (2 * kPi * 60.0), 1e-6) << t;
    }
    EXPECT_EQ(after.V[k], before.V[k]);
  }
  EXPECT_EQ(measured("FREQLAG", {0.0}, before).df, before.df);
  Phasors steady = before;
  std::ranges::fill(steady.df, 0.01);
  for (const double df : measured("FREQLAG", {kLag}, steady).df) EXPECT_NEAR(df, 0.01, 1e-15);
}

}  // namespace
}  // namespace swingbank::sim::effects
