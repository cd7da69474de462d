// Noise, gaps and quantisation against hand-calculated statistics and rounding.
#include <algorithm>

#include "tests/sim/effects/measurement_bench.hpp"

namespace swingbank::sim::effects {
namespace {

using test::measured;

constexpr std::size_t kMany = 40000;

Phasors constant(std::size_t samples = kMany, double rate = 60.0) {
  return {rate, 60.0, std::vector<std::complex<double>>(samples, std::polar(1.1, 0.4)),
          std::vector<std::complex<double>>(samples, std::polar(0.7, -0.2)),
          std::vector<double>(samples, 0.001)};
}

struct Moments {
  double mean = 0.0, deviation = 0.0, outside = 0.0;  ///< outside: fraction beyond two deviations
};
template <class Value>
Moments moments(std::size_t n, const Value& value) {
  Moments m;
  for (std::size_t k = 0; k < n; ++k) m.mean += value(k) / static_cast<double>(n);
  for (std::size_t k = 0; k < n; ++k)
    m.deviation += (value(k) - m.mean) * (value(k) - m.mean) / static_cast<double>(n);
  m.deviation = std::sqrt(m.deviation);
  for (std::size_t k = 0; k < n; ++k)
    m.outside += (std::fabs(value(k) - m.mean) > 2 * m.deviation) / static_cast<double>(n);
  return m;
}

/// Expects a normal distribution of 40,000 samples: mean within 4 deviations / 200, deviation within 4 /
/// sqrt(2) / 200 = 1.5 %, 4.55 % beyond two deviations within 4 sqrt(0.0455 / 40000) = 0.43 %.
void expect_normal(const Moments& m, double mean, double deviation) {
  EXPECT_NEAR(m.mean, mean, 0.02 * deviation);
  EXPECT_NEAR(m.deviation, deviation, 0.015 * deviation);
  EXPECT_NEAR(m.outside, 0.0455, 0.0043);
}

TEST(Noise, HasTheRequestedStandardDeviations) {
  const Phasors a = measured("NOISE", {0.002, 0, 0, 0.001, 0.005}, constant(), 3);
  expect_normal(moments(kMany, [&](std::size_t k) { return std::abs(a.V[k]); }), 1.1, 0.0022);
  expect_normal(moments(kMany, [&](std::size_t k) { return std::abs(a.I[k]); }), 0.7, 0.0014);
  expect_normal(moments(kMany, [&](std::size_t k) { return std::arg(a.V[k]); }), 0.4, 0.001);
  expect_normal(moments(kMany, [&](std::size_t k) { return std::arg(a.I[k]); }), -0.2, 0.001);
  expect_normal(moments(kMany, [&](std::size_t k) { return 60 * a.df[k]; }), 0.06, 0.005);
  const Phasors b = measured("NOISE", {0, 0.003, 0.001, 0, 0}, constant(), 3);
  expect_normal(moments(kMany, [&](std::size_t k) { return b.V[k].real(); }), 1.1 * std::cos(0.4), 0.003);
  expect_normal(moments(kMany, [&](std::size_t k) { return b.V[k].imag(); }), 1.1 * std::sin(0.4), 0.003);
  expect_normal(moments(kMany, [&](std::size_t k) { return b.I[k].imag(); }), -0.7 * std::sin(0.2), 0.001);
}

TEST(Noise, IsIndependentOfChannelAndNeighbour) {
  const Phasors a = measured("NOISE", {0.01, 0, 0, 0, 0}, constant(), 5);
  double across = 0.0, along = 0.0;
  for (std::size_t k = 0; k + 1 < kMany; ++k) {
    const double v = (std::abs(a.V[k]) - 1.1) / 0.011, i = (std::abs(a.I[k]) - 0.7) / 0.007;
    across += v * i / kMany;
    along += v * (std::abs(a.V[k + 1]) - 1.1) / 0.011 / kMany;
  }
  EXPECT_NEAR(across, 0.0, 0.02);  // 4 / sqrt(40000)
  EXPECT_NEAR(along, 0.0, 0.02);
}

TEST(Noise, DependsOnTheSeedOnly) {
  const std::vector<double> p = {0.001, 0, 0, 0.001, 0.001};
  const Phasors whole = measured("NOISE", p, constant(), 9), part = measured("NOISE", p, constant(100), 9);
  EXPECT_TRUE(std::equal(part.V.begin(), part.V.end(), whole.V.begin()));
  EXPECT_TRUE(std::equal(part.df.begin(), part.df.end(), whole.df.begin()));
  const Phasors quiet = measured("NOISE", {0.001, 0, 0, 0.001, 0}, constant(100), 9);
  EXPECT_EQ(quiet.V, part.V);
  EXPECT_EQ(quiet.df, constant(100).df);
  EXPECT_NE(measured("NOISE", p, constant(100), 10).V, part.V);
}

TEST(Gaps, HaveTheRequestedRateAndLength) {
  // Gaps of 0.2 s, 0.5 of them per second of good record at 60/s: a fraction of 0.1 / 1.1 is missing.
  const std::size_t n = 600000;
  const Phasors a = measured("GAPS", {0.5, 0.2}, constant(n), 4);
  std::size_t missing = 0, gaps = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const bool gone = std::isnan(a.V[k].real());
    EXPECT_EQ(gone, std::isnan(a.I[k].real()) && std::isnan(a.df[k]));
    missing += gone;
    gaps += gone && !std::isnan(a.V[k - 1].real());
  }
  const double share = static_cast<double>(missing) / n;
  const double length = static_cast<double>(missing) / 60.0 / static_cast<double>(gaps);
  // About 4500 gaps of geometric length: 4 / sqrt(4500) = 6 %, and one in 24 gaps runs into the next.
  EXPECT_NEAR(length, 0.2, 0.06 * 0.2 + 0.01);
  EXPECT_NEAR(share, 0.1 / 1.1, 0.08 * 0.1 / 1.1);
  EXPECT_FALSE(std::isnan(a.V[0].real()));
}

TEST(Gaps, ShorterThanASampleAreOneSample) {
  const Phasors a = measured("GAPS", {1.0, 0.001}, constant(6000), 4);
  int runs = 0;
  for (std::size_t k = 1; k < 6000; ++k) runs += std::isnan(a.df[k]) && std::isnan(a.df[k - 1]);
  const auto gone = std::ranges::count_if(a.df, [](double v) { return std::isnan(v); });
  EXPECT_NEAR(static_cast<double>(gone), 100.0, 40.0);  // Poisson, 4 sqrt(100)
  EXPECT_LE(runs, 8);                                   // adjacent gaps by chance: 100 / 60
}

TEST(Quantise, RoundsToTheNearestStep) {
  Phasors one{60.0, 60.0, {std::polar(1.0234, 0.30004)}, {std::polar(0.7777, -1.0)}, {0.0123 / 60.0}};
  const Phasors a = measured("QUANTISE", {0.005, 0.1, 0, 0.005}, one);
  EXPECT_NEAR(std::abs(a.V[0]), 1.025, 1e-15);
  EXPECT_NEAR(std::arg(a.V[0]), 0.30004, 1e-15);
  EXPECT_NEAR(std::abs(a.I[0]), 0.8, 1e-15);
  EXPECT_NEAR(a.df[0] * 60.0, 0.010, 1e-15);
  const Phasors b = measured("QUANTISE", {0, 0, 0.01, 0}, one);
  EXPECT_NEAR(std::abs(b.V[0]), 1.0234, 1e-15);
  EXPECT_NEAR(std::arg(b.V[0]), 0.30, 1e-15);
  EXPECT_NEAR(std::arg(b.I[0]), -1.0, 1e-15);
  EXPECT_EQ(b.df, one.df);
}

}  // namespace
}  // namespace swingbank::sim::effects
