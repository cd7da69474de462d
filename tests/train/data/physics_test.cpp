// Physical channels and their whitening.
#include "train/data/physics.hpp"

#include <cmath>
#include <numeric>

#include "base/problem.hpp"
#include "tests/train/data/fixture.hpp"
#include "train/data/features.hpp"

namespace swingbank::train::data {
namespace {

const std::vector<std::string> kNames = {"speed", "P", "Q", "V", "Ifd", "frequency"};

/// A record that is steady until 1 s, and then consists of simple functions of the time since then.
std::vector<float> record(double rate, std::size_t samples) {
  std::vector<float> r(kNames.size() * samples);
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = std::max(0.0, static_cast<double>(k) / rate - 1.0);
    const double of[] = {0.01 * std::sin(t), 0.8 + 0.3 * t, 0.2, 1.0 - 0.1 * t, 2.0 + t, 0.02 * std::sin(t)};
    for (std::size_t c = 0; c < kNames.size(); ++c) r[c * samples + k] = static_cast<float>(of[c]);
  }
  return r;
}

TEST(Physics, ContainsTheVariablesOfTheMachineEquations) {
  constexpr double rate = 120, X = 0.3;
  constexpr std::size_t samples = 720;
  const Physics physics(kNames, {rate, 0.5, 6.0, 1.0, X});
  ASSERT_EQ(physics.channels(), 12u);
  std::vector<float> out(physics.channels() * physics.bins() + physics.levels());
  const auto in = record(rate, samples);
  physics.apply(in.data(), samples, out.data());
  // the bin that begins at 2.0 s is 1/30 s long; the bin before it is a single sample
  const std::size_t at = 180;
  const auto value = [&](std::size_t channel, std::size_t bin) {
    return out[channel * physics.bins() + bin];
  };
  const double t = 1.0 + 1.5 / rate;  // middle of the four samples, after the event
  const double P = 0.8 + 0.3 * t, V = 1.0 - 0.1 * t, Q = 0.2;
  const double E = std::hypot(V + X * Q / V, X * P / V), E0 = std::hypot(1.06, 0.24);
  constexpr double kCurved =
      2e-5;  // difference between the mean of four samples and the value in their middle
  EXPECT_NEAR(value(0, at), P / V - 0.8, kCurved);
  EXPECT_NEAR(value(1, at), Q / V - 0.2, kCurved);
  EXPECT_NEAR(value(2, at), V - 1.0, kCurved);
  EXPECT_NEAR(value(3, at), E - E0, kCurved);
  EXPECT_NEAR(value(4, at), std::atan2(X * P / V, V + X * Q / V) - std::atan2(0.24, 1.06), kCurved);
  EXPECT_NEAR(value(5, at), 0.15 * t * t, kCurved);
  EXPECT_NEAR(value(6, at), 0.01 * std::sin(t), kCurved);
  EXPECT_NEAR(value(7, at), 0.01 * (1 - std::cos(t)), kCurved);
  EXPECT_NEAR(value(8, at), t, kCurved);
  EXPECT_NEAR(value(9, at), 0.5 * t * t, 3 * kCurved);
  EXPECT_NEAR(value(10, at), 0.02 * std::sin(t), kCurved);
  EXPECT_NEAR(value(11, at), -0.01 * (1 - std::cos(t)), kCurved);
  const std::vector<float> levels(out.end() - 6, out.end());
  const double steady[] = {0.8, 0.2, 1.0, E0, std::atan2(0.24, 1.06), 2.0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(levels[i], steady[i], 1e-6) << i;
}

TEST(Physics, CoarsensAfterTheEventAndEndsInsideTheWindow) {
  const Physics physics(kNames, {120, 0.5, 10.0, 1.0, 0.3});
  // 0.5 to 2 s sample by sample, to 6 s in bins of 1/30 s, to 10 s in bins of 1/15 s
  EXPECT_EQ(physics.bins(), 180u + 120u + 60u);
  EXPECT_EQ(physics.samples(), 1200u);
}

TEST(Physics, UsesTheAvailableChannels) {
  EXPECT_EQ(Physics({"P", "Q", "V"}, {60, 0, 2, 1, 0.3}).channels(), 6u);
  EXPECT_EQ(Physics({"P", "Q", "V", "frequency"}, {60, 0, 2, 1, 0.3}).channels(), 6u);
  EXPECT_EQ(Physics({"P", "Q", "V", "Ifd"}, {60, 0, 2, 1, 0.3}).levels(), 6u);
  try {
    (void)Physics({"P", "speed"}, {60, 0, 2, 1, 0.3});
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_EQ(e.problems().size(), 2u) << e.what();
  }
}

TEST(Whitening, DecorrelatesAndNormalisesAndIsRestoredFromAFile) {
  test::Folder folder("white");
  test::Plan plan;
  plan.electrical = true;
  plan.rows = 2000;
  plan.rows_per_shard = 500;
  const mpi::store::Dataset dataset = test::make_dataset(folder.path, plan);
  InputRecipe recipe{{"P", "Q", "V", "speed"}, 0.0, 2.0, 1, InputForm::physics};
  const ShardStream stream(dataset, recipe);
  const auto rows = test::all_rows(dataset.rows);
  const Features features = Features::fit(stream, rows, 5);
  ASSERT_EQ(features.channels(), 1u);
  const std::size_t n = features.length(), kept = features.sizes().kept;
  ASSERT_GT(kept, 5u);
  std::vector<float> series(rows.size() * stream.selection().values()), out(rows.size() * n), again = out;
  stream.read(rows, series.data());
  features.apply(series.data(), rows.size(), out.data());
  std::vector<double> mean(kept), product(kept * kept);
  const auto x = [&](std::size_t r, std::size_t i) { return std::sinh(static_cast<double>(out[r * n + i])); };
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t i = 0; i < kept; ++i) {
      mean[i] += x(r, i) / 2000;
      for (std::size_t k = 0; k <= i; ++k) product[i * kept + k] += x(r, i) * x(r, k) / 2000;
    }
  for (std::size_t i = 0; i < kept; ++i) {
    EXPECT_NEAR(mean[i], 0.0, 0.02) << i;  // single precision, and components with 1e-9 of the variance
    for (std::size_t k = 0; k <= i; ++k)
      EXPECT_NEAR(product[i * kept + k], i == k ? 1.0 : 0.0, 0.05) << i << ", " << k;
  }
  Features::restore(features.sizes(), features.arrays()).apply(series.data(), rows.size(), again.data());
  EXPECT_EQ(out, again);
}

/// Physical series of a synthetic dataset whose rows draw their noise.
struct NoisyWorld {
  test::Folder folder{"white-noise"};
  mpi::store::Dataset dataset = made(folder.path);
  ShardStream stream{dataset, recipe(), {.noise = {0.0, 1, NoiseLevels{1e-4, 5e-3, 0.25}}}};
  static mpi::store::Dataset made(const std::filesystem::path& path) {
    test::Plan plan;
    plan.electrical = true;
    plan.rows = 2000;
    plan.rows_per_shard = 500;
    return test::make_dataset(path, plan);
  }
  static InputRecipe recipe() {
    InputRecipe r{{"P", "Q", "V", "speed"}, 0.0, 2.0, 1, InputForm::physics};
    r.shows_level = true;
    return r;
  }
  [[nodiscard]] std::vector<float> features(const Features& f, const Noise& noise) const {
    const auto rows = test::all_rows(dataset.rows);
    std::vector<float> series(rows.size() * stream.selection().values()), out(rows.size() * f.length());
    stream.read(rows, series.data(), noise);
    f.apply(series.data(), rows.size(), out.data());
    return out;
  }
};

TEST(Whitening, ShrinksNoisyComponentsAndIncludesTheLevel) {
  const NoisyWorld w;
  const Features f = Features::fit(w.stream, test::all_rows(w.dataset.rows), 5);
  EXPECT_EQ(f.sizes().noisy, 1u);
  const std::size_t n = f.length(), kept = f.sizes().kept;
  const auto clean = w.features(f, Noise{0.0}), noisy = w.features(f, Noise{0.005});
  const auto mean_square = [&](const std::vector<float>& x, std::size_t i) {
    double sum = 0.0;
    for (std::size_t r = 0; r < w.dataset.rows; ++r) sum += std::pow(std::sinh(x[r * n + i]), 2.0);
    return sum / static_cast<double>(w.dataset.rows);
  };
  std::size_t shrunk = 0;
  for (std::size_t i = 0; i < kept; ++i) {
    EXPECT_NEAR(mean_square(clean, i), 1.0, 0.1) << i;
    EXPECT_LT(mean_square(noisy, i), 1.3) << i;  // signal plus noise, multiplied by the Wiener factor
    shrunk += mean_square(noisy, i) < 0.5;
  }
  EXPECT_GT(shrunk, 0u);
  EXPECT_EQ(clean[n - 1], std::asinh(level_input(0.0)));
  EXPECT_EQ(noisy[n - 1], std::asinh(level_input(0.005)));
  const Features again = Features::restore(f.sizes(), f.arrays());
  EXPECT_EQ(w.features(again, Noise{0.005}), noisy);
}

}  // namespace
}  // namespace swingbank::train::data
