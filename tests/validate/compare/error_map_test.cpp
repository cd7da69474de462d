#include "validate/compare/error_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "validate/compare/error_map_table.hpp"

namespace swingbank::validate::compare {
namespace {

/// White noise of known standard deviation `sigma` [pu].
ChannelNoise white_noise(double sigma) { return {.sigma = sigma, .covariance = {sigma * sigma}}; }

constexpr double kRate = 60;
/// 20 s at 60/s; the event is from 2 to 2.1 s.
std::vector<double> times() {
  std::vector<double> t;
  for (int k = 0; k <= 1200; ++k) t.push_back(k / kRate);
  return t;
}
std::vector<Window> windows() {
  constexpr double slack = 1e-6;  // a sample at a switching time belongs to the window before it
  return {{"pre-event", 0, 2 + slack},
          {"fault", 2 + slack, 2.1 + slack},
          {"0–1 s after", 2.1 + slack, 3.1 + slack},
          {"1–5 s after", 3.1 + slack, 7.1 + slack},
          {"> 5 s after", 7.1 + slack, 20 + slack}};
}
/// First-order autoregressive noise of standard deviation sigma.
std::vector<double> noise(double sigma, double a, unsigned seed, std::size_t n = 1201) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x(n);
  double state = normal(generator);
  for (double& v : x) {
    v = sigma * state;
    state = a * state + std::sqrt(1 - a * a) * normal(generator);
  }
  return x;
}

TEST(ErrorMapTest, BinsContainResolvableFrequencies) {
  const auto t = times();
  const ErrorMap map = error_map(t, noise(1, 0, 1), windows(), white_noise(1));
  const std::vector<std::vector<bool>> resolved = {{false, true, true, true},
                                                   {false, false, false, true},
                                                   {false, true, true, true},
                                                   {false, true, true, true},
                                                   {true, true, true, true}};
  for (std::size_t w = 0; w < 5; ++w)
    for (std::size_t b = 0; b < 4; ++b)
      EXPECT_EQ(!map.rows[w].bands[b].empty(), resolved[w][b]) << w << " " << b;
  EXPECT_EQ(map.rows[0].all.values, 120);  // 121 samples, less their mean
  EXPECT_EQ(map.rows[1].all.values, 6);
  EXPECT_EQ(map.whole.values, 1200);
  // 12.9 s: modes 0 ... 2 lie below 0.1 Hz, 3 ... 20 below 0.8 Hz.
  EXPECT_EQ(map.rows[4].bands[0].values, 3);
  EXPECT_EQ(map.rows[4].bands[1].values, 18);
}

/// Expects a mean square of 1 in each bin over many draws, as for a correct noise estimate.
void expect_unit(double colour, bool estimated) {
  const auto t = times();
  constexpr int kDraws = 150;
  std::vector<std::vector<double>> sum(5, std::vector<double>(5));
  const auto w = windows();
  ChannelNoise known = white_noise(1);
  for (int d = 1; colour > 0 && d < 60; ++d) known.covariance.push_back(std::pow(colour, d));
  int values[5][5] = {};
  for (unsigned draw = 0; draw < kDraws; ++draw) {
    const auto x = noise(1, colour, 100 + draw);
    const ChannelNoise model = estimated ? estimate_noise(std::span(x).first(121), 1e-4) : known;
    const ErrorMap map = error_map(t, x, w, model);
    for (std::size_t i = 0; i < 5; ++i)
      for (std::size_t b = 0; b < 5; ++b) {
        const TimeFrequencyBin& bin = b == 4 ? map.rows[i].all : map.rows[i].bands[b];
        values[i][b] = bin.values;
        if (!bin.empty()) sum[i][b] += bin.normalised * bin.normalised / kDraws;
      }
  }
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t b = 0; b < 5; ++b)
      if (values[i][b] > 0) {
        // A mean of kDraws * values squares of normal numbers: five standard errors. An estimated variance
        // (120 samples, or a coloured spectrum) adds a factor of 1/(1 - 2/nu), up to 10 %.
        EXPECT_NEAR(sum[i][b], 1, 5 * std::sqrt(2.0 / (kDraws * values[i][b])) + (estimated ? 0.1 : 0))
            << i << " " << b;
      }
}
TEST(ErrorMapTest, NormalisesWhiteNoiseToOne) { expect_unit(0, false); }
TEST(ErrorMapTest, NormalisesColouredNoiseToOne) { expect_unit(0.8, false); }
TEST(ErrorMapTest, NoiseIsEstimatedBeforeTheEvent) { expect_unit(0, true); }

TEST(ErrorMapTest, SineAppearsInItsBandAndWindow) {
  const auto t = times();
  const auto w = windows();
  const struct {
    std::size_t window, band;
    double frequency;
  } cases[] = {{4, 0, 0.05}, {4, 1, 0.4}, {3, 1, 0.4}, {3, 2, 1.5}, {2, 2, 1.5}, {2, 3, 8.0}, {0, 3, 10.0}};
  for (const auto& c : cases) {
    auto x = noise(1, 0, 5);
    // A cosine with zero slope at both ends has no leakage.
    const double length = w[c.window].to - w[c.window].from, from = w[c.window].from;
    const double k = std::round(2 * length * c.frequency);
    for (std::size_t i = 0; i < t.size(); ++i)
      if (t[i] > from && t[i] <= w[c.window].to)
        x[i] += 8 * std::cos(std::numbers::pi * k * (t[i] - from) / length);
    ErrorMap map = error_map(t, x, w, white_noise(1));
    ErrorMap* maps[] = {&map};
    set_bounds(maps, 0.001);
    for (std::size_t i = 0; i < 5; ++i)
      for (std::size_t b = 0; b < 4; ++b)
        EXPECT_EQ(map.rows[i].bands[b].exceeds(), i == c.window && b == c.band)
            << c.window << " " << c.band << " seen in " << i << " " << b << ": "
            << map.rows[i].bands[b].normalised;
    EXPECT_TRUE(map.rows[c.window].all.exceeds() && map.whole.exceeds());
  }
}

TEST(ErrorMapTest, OffsetOfAShortWindowAppearsInTheTotal) {
  const auto t = times();
  auto x = noise(1, 0, 6);
  for (std::size_t i = 0; i < t.size(); ++i)
    if (t[i] > 3.11 && t[i] < 7.11) x[i] += 3;
  ErrorMap map = error_map(t, x, windows(), white_noise(1));
  ErrorMap* maps[] = {&map};
  set_bounds(maps, 0.001);
  EXPECT_TRUE(map.rows[3].all.exceeds());
  EXPECT_FALSE(map.rows[4].all.exceeds());
  EXPECT_NEAR(map.rows[3].all.rms, std::sqrt(10.0), 0.2);  // 240 samples: 3 s.e. of the rms
}

TEST(ErrorMapTest, IncludesErrorOfTheStartInTheNoise) {
  // An offset of 1/11: one standard error of the mean of the 121 quiet samples, and 2.5 standard errors of
  // the mean of the window's 774 samples.
  const auto t = times();
  std::vector<double> x(t.size(), 1.0 / 11);
  const double exact = error_map(t, x, windows(), white_noise(1), {.quiet = 0}).rows[4].bands[0].normalised;
  const double started =
      error_map(t, x, windows(), white_noise(1), {.quiet = 121}).rows[4].bands[0].normalised;
  EXPECT_NEAR(exact, std::sqrt(774.0 / 121 / 3), 0.01);
  EXPECT_NEAR(started, std::sqrt(774.0 / 121 / 3 / (1 + 774.0 / 121)), 0.01);
}

TEST(NoiseModelTest, EstimatesDeviationAndColour) {
  const auto x = noise(0.002, 0.7, 3, 4000);
  const ChannelNoise model = estimate_noise(x, 1e-5);
  EXPECT_NEAR(model.sigma, 0.002, 0.0002);  // 4000 samples correlated over 3: 3 s.e. are 8 %
  EXPECT_NEAR(model.covariance[1] / model.covariance[0], 0.7, 0.05);
  // (1 + a) / (1 - a) = 5.7 times the variance; 3 s.e. of an AR(1) spectrum at zero are 20 %.
  EXPECT_NEAR(model.slow() / (0.002 * 0.002), 1.7 / 0.3, 1.2);
  EXPECT_NEAR(estimate_noise(std::vector<double>(100, 3.0), 1e-4).sigma, 1e-4, 1e-12);
}

TEST(NoiseBoundTest, MatchesTables) {
  // Chi-square: 99.9 % of 10 is 29.588; F: 99 % of (5, 10) is 5.636 and of (1, 120) is 6.851.
  EXPECT_NEAR(noise_bound(10, 0, 0.001), std::sqrt(2.9588), 1e-4);
  EXPECT_NEAR(noise_bound(5, 10, 0.01), std::sqrt(5.636), 1e-4);
  EXPECT_NEAR(noise_bound(1, 120, 0.01), std::sqrt(6.851), 1e-4);
}

TEST(NoiseBoundTest, NoiseAloneStaysBelowAllBounds) {
  const auto t = times();
  const auto w = windows();
  int above = 0;
  for (unsigned draw = 0; draw < 300; ++draw) {
    const auto x = noise(1, 0, 9000 + draw);
    ErrorMap map = error_map(t, x, w, estimate_noise(std::span(x).first(121), 1e-4), {.quiet = 121});
    ErrorMap* maps[] = {&map};
    set_bounds(maps, 0.02);
    bool any = map.whole.exceeds();
    for (const auto& row : map.rows) {
      any = any || row.all.exceeds();
      for (const auto& bin : row.bands) any = any || bin.exceeds();
    }
    above += any;
  }
  // At most 2 % of 300 draws: the bins overlap, so Bonferroni is conservative; 6 + 3 sqrt(6) draws at most.
  // Spurious colour adds a little.
  EXPECT_LE(above, 14);
  EXPECT_GT(above, 0);
}

TEST(MapSentenceTest, NamesTheWindowAndBandOfTheLargestError) {
  const auto t = times();
  const auto w = windows();
  std::vector<double> off = noise(1, 0, 5), also = noise(1, 0, 6), quiet = noise(1, 0, 7);
  for (std::size_t k = 0; k < t.size(); ++k)
    if (t[k] > w[4].from) {
      off[k] += 20 * std::sin(2 * std::numbers::pi * 0.4 * t[k]);
      also[k] += 5 * std::sin(2 * std::numbers::pi * 0.4 * t[k]);
    }
  ErrorMap a = error_map(t, off, w, white_noise(1)), b = error_map(t, also, w, white_noise(1)),
           c = error_map(t, quiet, w, white_noise(1));
  ErrorMap* maps[] = {&a, &b, &c};
  set_bounds(maps, 0.02);
  const std::string text = map_sentence(
      {{"e1", "P", "MW", 1, &w, &a}, {"e2", "P", "MW", 1, &w, &b}, {"e1", "Q", "Mvar", 1, &w, &c}});
  EXPECT_TRUE(text.starts_with(
      "P: largest exceedance of a noise limit in the window > 5 s after the last switching, band 0.1–0.8 Hz: "
      "normalised RMS "))
      << text;
  EXPECT_TRUE(text.ends_with(
      "This bin exceeds its limit in 2 of 2 events. Q: all bins are within their noise limits."))
      << text;
}

}  // namespace
}  // namespace swingbank::validate::compare
