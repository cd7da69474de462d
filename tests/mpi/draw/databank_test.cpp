#include "mpi/draw/databank.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "mpi/draw/detail/neighbours.hpp"
#include "mpi/draw/detail/random.hpp"
#include "tests/mpi/draw/temporary_config.hpp"

namespace swingbank::mpi::draw {
namespace {

using ::testing::HasSubstr;

Databank draw(const DatasetConfig& c, std::uint64_t points) {
  sim::plant::Plant plant;
  plant.machine = {&c.effect(), c.effect().default_parameters()};
  return draw_databank(c, plant, points);
}

/// Smallest distance over all pairs, by brute force.
double closest_pair(const Databank& b) {
  double least = 1e300;
  for (std::size_t i = 0; i < b.points(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double sum = 0.0;
      for (std::size_t k = 0; k < b.dimensions; ++k)
        sum += (b.point(i)[k] - b.point(j)[k]) * (b.point(i)[k] - b.point(j)[k]);
      least = std::min(least, sum);
    }
  return std::sqrt(least);
}

/// The serial definition of the databank: every admissible candidate in order, compared with all points so
/// far.
std::vector<double> brute_force(const DatasetConfig& c, std::uint64_t points) {
  std::vector<double> values, full = c.effect().default_parameters(), x(c.box.size());
  const std::size_t n = x.size();
  for (std::uint64_t k = 0; values.size() < points * n; ++k) {
    Random random(c.seed, Stream::databank, k);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = c.box[i].sampled() ? random.uniform(c.box[i].low, c.box[i].high) : c.box[i].low;
      full[static_cast<std::size_t>(c.box[i].index)] = x[i];
    }
    bool good = c.effect().unphysical(full.data()).empty();
    for (std::size_t j = 0; good && j < values.size(); j += n) {
      double sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) sum += (values[j + i] - x[i]) * (values[j + i] - x[i]);
      good = std::sqrt(sum) >= c.databank.distance;
    }
    if (good) values.insert(values.end(), x.begin(), x.end());
  }
  return values;
}

TEST(DatabankDraw, EqualsTheSerialDefinition) {
  const DatasetConfig c = test::genrou_box();
  EXPECT_EQ(draw(c, 3000).values, brute_force(c, 3000));
}

TEST(DatabankDraw, EveryPairKeepsTheMinimumDistance) {
  EXPECT_GE(closest_pair(draw(test::genrou_box(), 4000)), 0.7);
}

TEST(DatabankDraw, PointsArePhysicalAndInTheBox) {
  const DatasetConfig c = test::genrou_box();
  const Databank b = draw(c, 2000);
  std::vector<double> full = c.effect().default_parameters();
  for (std::size_t i = 0; i < b.points(); ++i) {
    for (std::size_t k = 0; k < b.dimensions; ++k) {
      EXPECT_GE(b.point(i)[k], c.box[k].low);
      EXPECT_LE(b.point(i)[k], c.box[k].high);
      full[static_cast<std::size_t>(c.box[k].index)] = b.point(i)[k];
    }
    EXPECT_EQ(c.effect().unphysical(full.data()), "");
  }
  EXPECT_EQ(
      b.candidates, 2000 + b.too_close + [&] {
        std::uint64_t n = 0;
        for (const auto& r : b.refused) n += r.second;
        return n;
      }());
}

TEST(DatabankDraw, FewerPointsAreThePrefix) {
  const DatasetConfig c = test::genrou_box();
  const Databank small = draw(c, 500), large = draw(c, 1000);
  EXPECT_TRUE(std::equal(small.values.begin(), small.values.end(), large.values.begin()));
}

TEST(DatabankDraw, SeedChangesThePoints) {
  DatasetConfig c = test::genrou_box();
  const Databank a = draw(c, 10);
  c.seed = 2;
  EXPECT_NE(draw(c, 10).values, a.values);
}

TEST(DatabankDraw, AcceptsEveryPointWithoutDistance) {
  DatasetConfig c = test::genrou_box();
  c.databank.distance = 0.0;
  EXPECT_EQ(draw(c, 5000).too_close, 0u);
}

TEST(DatabankDraw, ReportsProgress_WhenTheCountIsUnreachable) {
  DatasetConfig c = test::genrou_box();
  c.databank.scaled = true;
  c.databank.distance = 1.5;  // the unit cube's diagonal is 3.6: a few hundred points at most
  try {
    draw(c, 2000);
    FAIL() << "nothing thrown";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr(" of 2000 samples at genrou.toml"));
    EXPECT_THAT(e.what(), HasSubstr("closer than the minimum distance"));
  }
}

// 19 of 20 admissible candidates are too close, so the forecast of the count applies after the first batch
// of candidates.
TEST(DatabankDraw, DoesNotAbort_WhenTheCountIsReachable) {
  DatasetConfig c = test::genrou_box();
  c.databank.distance = 2.0;
  c.databank.candidates_per_point = 1000;
  const Databank whole = draw(c, 250);
  EXPECT_GT(whole.too_close, 10 * whole.points());
  const auto admissible = static_cast<double>(whole.points() + whole.too_close);
  c.databank.candidates_per_point = (1.2 * admissible - 1000) / 250;  // 20 % more than needed
  EXPECT_EQ(draw(c, 250).values, whole.values);
}

// 60,000 points as in the thesis: checks every pair and that drawing takes seconds only.
TEST(DatabankDrawFull, SixtyThousandPoints) {
  const Databank b = draw(test::genrou_box(), 60000);
  ASSERT_EQ(b.points(), 60000u);
  EXPECT_GE(closest_pair(b), 0.7);
}

TEST(RandomNumbers, AreUniformAndDistinctByStreamAndId) {
  double sum = 0.0, square = 0.0;
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double u = Random(1, Stream::fault, static_cast<std::uint64_t>(i)).uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    square += u * u;
  }
  // Four standard errors: 0.289/sqrt(n) = 9.1e-4 for the mean, 0.298/sqrt(n) = 9.4e-4 for the mean square.
  EXPECT_NEAR(sum / n, 0.5, 3.7e-3);
  EXPECT_NEAR(square / n, 1.0 / 3.0, 3.8e-3);
  EXPECT_NE(Random(1, Stream::fault, 5).uniform(), Random(1, Stream::databank, 5).uniform());
  EXPECT_NE(Random(1, Stream::fault, 5).uniform(), Random(2, Stream::fault, 5).uniform());
  Random r(1, Stream::fault, 5);
  EXPECT_NE(r.uniform(), r.uniform());
}

// Known answer of Philox4x32-10 for counter and key zero, from Random123's kat_vectors.
TEST(RandomNumbers, PhiloxKnownAnswer) {
  const auto r = r123::Philox4x32()({{0, 0, 0, 0}}, {{0, 0}});
  EXPECT_EQ(r[0], 0x6627e8d5u);
  EXPECT_EQ(r[1], 0xe169c58du);
  EXPECT_EQ(r[2], 0xbc57ac4cu);
  EXPECT_EQ(r[3], 0x9b00dbd8u);
}

}  // namespace
}  // namespace swingbank::mpi::draw
