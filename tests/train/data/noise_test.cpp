// Noise of records: its dependencies and its standard deviation.
#include "train/data/noise.hpp"

#include <cmath>

#include "base/problem.hpp"
#include "tests/train/data/fixture.hpp"

namespace swingbank::train::data {
namespace {

constexpr std::size_t kSamples = 4000;

mpi::store::DatasetHeader header(std::vector<std::string> channels) {
  mpi::store::DatasetHeader h;
  h.frequency = 60;
  h.rate = 120;
  h.samples = kSamples;
  h.channel_names = std::move(channels);
  h.config = "record.frequency = [0.1, 0.02]\n";
  return h;
}
/// Noise added to a record of constant value.
std::vector<double> added(const std::vector<std::string>& channels, const NoiseRecipe& recipe,
                          std::uint64_t row, float value = 0) {
  std::vector<float> record(channels.size() * kSamples, value);
  RecordNoise(header(channels), recipe).add(row, record.data());
  std::vector<double> noise(record.begin(), record.end());
  for (double& n : noise) n -= value;
  return noise;
}
double deviation(std::span<const double> x) {
  double square = 0;
  for (const double v : x) square += v * v;
  return std::sqrt(square / static_cast<double>(x.size()));
}
std::span<const double> channel(const std::vector<double>& record, std::size_t c) {
  return {record.data() + c * kSamples, kSamples};
}

TEST(Noise, DependsOnSeedRowAndQuantityOnly) {
  const auto P = added({"P"}, {0.001, 1}, 5);
  const auto both = added({"V", "P"}, {0.001, 1}, 5);
  EXPECT_TRUE(std::ranges::equal(P, channel(both, 1)));
  EXPECT_FALSE(std::ranges::equal(P, channel(both, 0)));
  EXPECT_NE(P, added({"P"}, {0.001, 1}, 6));
  EXPECT_NE(P, added({"P"}, {0.001, 2}, 5));
}

TEST(Noise, HasTheScaleOfEachQuantity) {
  constexpr double kLevel = 0.005, kLoose = 0.04;  // 4000 samples determine a standard deviation to 1.1 %
  const auto noise = added({"P", "Q", "V", "theta", "Ifd", "speed"}, {kLevel, 1}, 0, 2.0f);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(deviation(channel(noise, c)) / kLevel, 1, kLoose);
  EXPECT_NEAR(deviation(channel(noise, 4)) / kLevel, 2, 2 * kLoose);
  EXPECT_NEAR(deviation(channel(noise, 5)) / kLevel, 0.05, 0.05 * kLoose);
}

TEST(Noise, OfFrequencyIsFilteredNoiseOfTheta) {
  const auto frequency = added({"frequency"}, {0.001, 1}, 3), theta = added({"theta"}, {0.001, 1}, 3);
  std::vector<double> angle(kSamples);
  sim::terminal_angle(frequency.data(), kSamples, 120, 60, {0.1, 0.02}, angle.data());
  for (std::size_t k = 0; k < kSamples; ++k) EXPECT_NEAR(angle[k], theta[k] - theta[0], 1e-6);
}

TEST(Noise, NamesChannelsThatNoInstrumentMeasures) {
  try {
    RecordNoise(header({"P", "delta", "Tm"}), {0.001, 1});
    FAIL() << "went on";
  } catch (const InputError& e) {
    const std::string sentence = e.what();
    EXPECT_NE(sentence.find("delta"), std::string::npos);
    EXPECT_NE(sentence.find("Tm"), std::string::npos);
  }
  EXPECT_NO_THROW(RecordNoise(header({"delta"}), {}));
}

TEST(Noise, IsTheSameInMemoryAndFromTheDiskAndInAnyOrder) {
  const test::Folder folder("noise");
  const auto dataset = test::make_dataset(folder.path);
  const StreamOptions kept{.noise = {0.01, 4}}, read{.memory_limit = 1, .readers = 2, .noise = {0.01, 4}};
  const ShardStream memory(dataset, test::whole_record(), kept), disk(dataset, test::whole_record(), read),
      plain(dataset, test::whole_record());
  const std::vector<std::uint64_t> rows = {399, 2, 2, 170};
  std::vector<float> a(rows.size() * memory.selection().values()), b = a, c = a;
  memory.read(rows, a.data());
  disk.read(rows, b.data());
  plain.read(rows, c.data());
  EXPECT_FALSE(disk.in_memory());
  EXPECT_EQ(a, b);
  EXPECT_NE(a, c);
}

constexpr NoiseLevels kLevels = {1e-4, 5e-3, 0.25};

TEST(Noise, TrainingLevelsAreDrawnPerRowAndDraw) {
  const RecordNoise noise(header({"P"}), {0.001, 1, kLevels});
  constexpr int kRows = 4000;
  int zero = 0, low = 0, moved = 0;
  for (std::uint64_t row = 0; row < kRows; ++row) {
    const double level = noise.level(row, {{}, 3});
    EXPECT_TRUE(level == 0 || (level >= kLevels.low && level <= kLevels.high)) << level;
    EXPECT_EQ(level, noise.level(row, {{}, 3}));
    zero += level == 0;
    low += level > 0 && level < std::sqrt(kLevels.low * kLevels.high);
    moved += level != noise.level(row, {{}, 4});
    EXPECT_EQ(noise.level(row, {0.001, 3}), 0.001);
  }
  EXPECT_NEAR(zero / double{kRows}, 0.25, 0.03);
  EXPECT_NEAR(low / double{kRows}, 0.375,
              0.03);  // below the middle of the logarithmic range: half of the other 0.75
  EXPECT_GT(moved, kRows * 9 / 10);
}

TEST(Noise, TrainingNoiseFollowsItsLevelAndDiffersBetweenDraws) {
  const RecordNoise noise(header({"P", "speed"}), {0.001, 1, kLevels});
  int noisy = 0;
  for (std::uint64_t row = 0; row < 40; ++row) {
    std::vector<float> record(2 * kSamples), again = record, other = record;
    noise.add(row, {{}, 5}, record.data());
    noise.add(row, {{}, 5}, again.data());
    noise.add(row, {{}, 6}, other.data());
    EXPECT_EQ(record, again);
    const double level = noise.level(row, {{}, 5});
    const std::vector<double> drawn(record.begin(), record.end());
    EXPECT_NEAR(deviation(channel(drawn, 0)), level, 0.06 * level);
    EXPECT_NEAR(deviation(channel(drawn, 1)), 0.05 * level, 0.003 * level);
    if (level == 0 || noise.level(row, {{}, 6}) == 0) continue;
    ++noisy;
    EXPECT_NE(record, other);
    double product = 0;
    for (std::size_t k = 0; k < kSamples; ++k) product += drawn[k] * drawn[kSamples + k];
    EXPECT_LT(std::abs(product) / kSamples / (0.05 * level * level),
              0.08);  // channels are uncorrelated
  }
  EXPECT_GT(noisy, 10);
}

TEST(Noise, TrainingNoiseIsTheSameInMemoryAndFromTheDisk) {
  const test::Folder folder("noise-training");
  test::Plan plan;
  plan.electrical = true;
  const auto dataset = test::make_dataset(folder.path, plan);
  InputRecipe recipe{{"P", "Q", "V", "speed"}, 0.0, 2.0, 1, InputForm::physics};
  recipe.shows_level = true;
  const ShardStream memory(dataset, recipe, {.noise = {0.001, 4, kLevels}}),
      disk(dataset, recipe, {.memory_limit = 1, .readers = 2, .noise = {0.001, 4, kLevels}});
  const std::vector<std::uint64_t> rows = {399, 2, 2, 170};
  const std::size_t values = memory.selection().values();
  std::vector<float> a(rows.size() * values), b = a, c = a;
  memory.read(rows, a.data(), memory.training(7));
  disk.read(rows, b.data(), disk.training(7));
  memory.read(rows, c.data());
  EXPECT_EQ(a, b);
  EXPECT_NE(a, c);
  EXPECT_EQ(c[values - 1], level_input(0.001));
  EXPECT_NEAR(level_of_input(level_input(0.003)), 0.003, 1e-8);
  EXPECT_NEAR(level_of_input(level_input(0)), 0, 1e-10);
}

}  // namespace
}  // namespace swingbank::train::data
