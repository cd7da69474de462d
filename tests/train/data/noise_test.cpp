// Noise of records: what it depends on, and how large it is.
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
/// What is added to a record of constant value.
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

TEST(Noise, DependsOnSeedRowAndQuantityAlone) {
  const auto P = added({"P"}, {0.001, 1}, 5);
  const auto both = added({"V", "P"}, {0.001, 1}, 5);
  EXPECT_TRUE(std::ranges::equal(P, channel(both, 1)));
  EXPECT_FALSE(std::ranges::equal(P, channel(both, 0)));
  EXPECT_NE(P, added({"P"}, {0.001, 1}, 6));
  EXPECT_NE(P, added({"P"}, {0.001, 2}, 5));
}

TEST(Noise, HasEachQuantitysSize) {
  constexpr double kLevel = 0.005, kLoose = 0.04;  // 4000 samples tell a deviation to 1.1 %
  const auto noise = added({"P", "Q", "V", "theta", "Ifd", "speed"}, {kLevel, 1}, 0, 2.0f);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(deviation(channel(noise, c)) / kLevel, 1, kLoose);
  EXPECT_NEAR(deviation(channel(noise, 4)) / kLevel, 2, 2 * kLoose);
  EXPECT_NEAR(deviation(channel(noise, 5)) / kLevel, 0.05, 0.05 * kLoose);
}

TEST(Noise, OfFrequencyIsThetasBehindItsFilter) {
  const auto frequency = added({"frequency"}, {0.001, 1}, 3), theta = added({"theta"}, {0.001, 1}, 3);
  std::vector<double> angle(kSamples);
  sim::terminal_angle(frequency.data(), kSamples, 120, 60, {0.1, 0.02}, angle.data());
  for (std::size_t k = 0; k < kSamples; ++k) EXPECT_NEAR(angle[k], theta[k] - theta[0], 1e-6);
}

TEST(Noise, NamesChannelsThatNoInstrumentShows) {
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

}  // namespace
}  // namespace swingbank::train::data
