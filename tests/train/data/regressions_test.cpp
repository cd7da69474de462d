// Regressions of each signal on pairs of other signals, and records divided into steps of one second.
#include "train/data/regressions.hpp"

#include <cmath>

#include "tests/train/data/fixture.hpp"
#include "train/data/features.hpp"
#include "train/data/split.hpp"

namespace swingbank::train::data {
namespace {

/// Index of the first of two coefficients of the regression of signal `of` on the signals `a` < `b`.
std::size_t place_of(std::size_t signals, std::size_t of, std::size_t a, std::size_t b) {
  std::size_t at = 0;
  for (std::size_t y = 0; y < signals; ++y)
    for (std::size_t i = 0; i < signals; ++i)
      for (std::size_t k = i + 1; k < signals; ++k) {
        if (i == y || k == y) continue;
        if (y == of && i == a && k == b) return at;
        at += 2;
      }
  return at;
}

TEST(Regressions, FindConstantRelationsAtAnyOffsetAndScale) {
  constexpr std::size_t kSignals = 4, kPoints = 90;
  std::vector<float> weights(kPoints), series(kSignals * kPoints), found(regression_count(kSignals));
  for (const float size : {1.0f, 1e-3f}) {
    for (std::size_t k = 0; k < kPoints; ++k) {
      const double t = 0.1 * static_cast<double>(k);
      weights[k] = k < 30 ? 1.0f : 4.0f;
      const double a = std::sin(t) + 7.0, b = std::exp(-0.3 * t) * std::cos(2.0 * t) - 2.0;
      const double all[] = {a, b, 2.0 * a - 0.5 * b + 11.0, t * t};
      for (std::size_t c = 0; c < kSignals; ++c) series[c * kPoints + k] = size * static_cast<float>(all[c]);
    }
    regress(series.data(), kSignals, weights, found.data());
    const std::size_t at = place_of(kSignals, 2, 0, 1);
    EXPECT_NEAR(found[at], 2.0, 1e-4) << size;
    EXPECT_NEAR(found[at + 1], -0.5, 1e-4) << size;
    const std::size_t back = place_of(kSignals, 0, 1, 2);  // a = (c + b / 2 - 11) / 2
    EXPECT_NEAR(found[back], 0.25, 1e-4) << size;
    EXPECT_NEAR(found[back + 1], 0.5, 1e-4) << size;
  }
}

TEST(Regressions, AreFiniteForIdenticalOrConstantSignals) {
  const std::vector<float> weights(5, 1.0f), series = {1, 2, 3, 4, 9, 1, 2, 3, 4, 9, 5, 5, 5, 5, 5};
  std::vector<float> found(regression_count(3));
  ASSERT_EQ(found.size(), 6u);
  regress(series.data(), 3, weights, found.data());
  for (const float c : found) EXPECT_TRUE(std::isfinite(c));
}

TEST(Regressions, FollowTheWhitenedFeaturesAndAreRestoredFromAFile) {
  test::Folder folder("regressed");
  test::Plan plan;
  plan.electrical = true;
  plan.rows = 600;
  const mpi::store::Dataset dataset = test::make_dataset(folder.path, plan);
  InputRecipe recipe{{"P", "Q", "V", "speed"}, 0.0, 2.0, 1, InputForm::physics};
  const auto rows = test::all_rows(dataset.rows);
  const auto made = [&](bool regressions, std::vector<float>& out) {
    recipe.regressions = regressions;
    const ShardStream stream(dataset, recipe);
    const Features features = Features::fit(stream, rows, 5);
    std::vector<float> series(rows.size() * stream.selection().values());
    stream.read(rows, series.data());
    out.resize(rows.size() * features.length());
    features.apply(series.data(), rows.size(), out.data());
    std::vector<float> again(out.size());
    Features::restore(features.sizes(), features.arrays()).apply(series.data(), rows.size(), again.data());
    EXPECT_EQ(out, again);
    return features.length();
  };
  std::vector<float> plain, more;
  const std::size_t n = made(false, plain), m = made(true, more);
  ASSERT_EQ(m, n + regression_count(8));  // with a speed there are eight signals
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(plain[r * n + i], more[r * m + i]) << r << ", " << i;
    for (std::size_t i = n; i < m; ++i) ASSERT_LE(std::abs(more[r * m + i]), 4.0f);
  }
}

TEST(Features, SecondsAsStepsReorderTheSameFeaturesInTime) {
  test::Folder folder("steps");
  test::Plan plan;
  plan.samples = 60;
  const mpi::store::Dataset dataset = test::make_dataset(folder.path, plan);
  InputRecipe recipe{{"P", "speed"}, 0.0, 3.0, 1, InputForm::absolute};
  const auto rows = test::all_rows(dataset.rows);
  constexpr std::size_t kComponents = 4, kSeconds = 3, kChannels = 2;
  std::vector<float> out[2];
  for (const bool steps : {false, true}) {
    recipe.seconds_as_steps = steps;
    const ShardStream stream(dataset, recipe);
    const Features features = Features::fit(stream, rows, kComponents);
    EXPECT_EQ(features.channels(), steps ? kChannels * kComponents : kChannels);
    EXPECT_EQ(features.length(), steps ? kSeconds : kSeconds * kComponents);
    std::vector<float> series(rows.size() * stream.selection().values());
    stream.read(rows, series.data());
    out[steps].resize(rows.size() * kChannels * kComponents * kSeconds);
    Features::restore(features.sizes(), features.arrays())
        .apply(series.data(), rows.size(), out[steps].data());
  }
  const std::size_t size = kChannels * kComponents * kSeconds;
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < kChannels; ++c)
      for (std::size_t k = 0; k < kComponents; ++k)
        for (std::size_t s = 0; s < kSeconds; ++s)
          ASSERT_EQ(out[0][r * size + c * kComponents * kSeconds + s * kComponents + k],
                    out[1][r * size + (c * kComponents + k) * kSeconds + s]);
}

TEST(Split, AcrossDatasetsTrainsOnOneAndJudgesTheOther) {
  Labels labels;
  labels.rows = 50;
  labels.parameters = 1;
  labels.judged = 20;
  for (std::size_t i = 0; i < labels.rows; ++i) {
    // two rows per databank point; the last ten rows have the points of the first ten, which are test rows
    labels.values.push_back(static_cast<double>(i / 2 % 20));
    labels.sample_id.push_back(i);
    labels.generator.push_back(30);
  }
  const RowSplit split = split_across(labels, 0.2, 1);
  ASSERT_EQ(split.test.size(), 20u);
  EXPECT_EQ(split.test.front(), 0u);
  EXPECT_EQ(split.test.back(), 19u);
  EXPECT_EQ(split.validation.size(), 4u);
  EXPECT_EQ(split.train.size(), 16u);
  for (const auto row : split.train) {
    EXPECT_GE(row, 20u);
    EXPECT_LT(row, 40u);
  }
  for (std::size_t i = 0; i < split.validation.size(); i += 2)
    EXPECT_EQ(split.validation[i] / 2, split.validation[i + 1] / 2)
        << "the rows of a databank point must be in one part of the split";
  labels.judged = 50;
  EXPECT_THROW((void)split_across(labels, 0.2, 1), InputError);
}

}  // namespace
}  // namespace swingbank::train::data
