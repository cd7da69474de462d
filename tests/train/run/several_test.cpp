// Combined test rows of one plant.
#include "train/run/detail/several.hpp"

#include <gtest/gtest.h>

#include "base/json.hpp"

namespace swingbank::train::run {
namespace {

/// Rows of three plants: plant 1 of generator 30 has four, plant 2 of generator 30 two, and plant 1 of
/// generator 31 three. The parameters are the plant's number and its double.
data::Labels labels() {
  data::Labels l;
  l.parameters = 2;
  for (const auto& [plant, generator] : {std::pair{1.0, 30},
                                         {2.0, 30},
                                         {1.0, 30},
                                         {1.0, 31},
                                         {1.0, 30},
                                         {2.0, 30},
                                         {1.0, 31},
                                         {1.0, 31},
                                         {1.0, 30}}) {
    l.values.insert(l.values.end(), {plant, 2 * plant});
    l.generator.push_back(generator);
  }
  l.rows = l.judged = l.generator.size();
  return l;
}
const std::vector<std::uint64_t> kAll = {0, 1, 2, 3, 4, 5, 6, 7, 8};

TEST(Several, GroupsRowsByGeneratorAndParameters) {
  const auto plants = plants_of(labels(), kAll);
  ASSERT_EQ(plants.size(), 2u);
  EXPECT_EQ(plants[0], (std::vector<std::size_t>{0, 2, 4, 8}));
  EXPECT_EQ(plants[1], (std::vector<std::size_t>{3, 6, 7}));
  EXPECT_TRUE(plants_of(labels(), std::vector<std::uint64_t>{0, 1, 2, 5}).empty());
}

TEST(Several, ErrorsOfOppositeSignAverageOut) {
  // plant 1 of #30: errors 3, 0, -3, 4 of the first parameter; of #31: 0, 0, 0
  const std::vector<double> errors = {3, 0, 0, 0, -3, 0, 0, 0, 4};
  std::vector<double> estimates = labels().values;
  for (std::size_t i = 0; i < errors.size(); ++i) estimates[2 * i] += errors[i];
  const auto found = several_json(labels(), kAll, estimates);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_DOUBLE_EQ(found[0]["mse_of_mean"], 9.0 / 4);  // one record: mean over two plants and two parameters
  EXPECT_NEAR(found[1]["mse_of_mean"].get<double>(), 0.0, 1e-20);  // three records: errors 3, 0, -3
  EXPECT_DOUBLE_EQ(found[2]["mse_of_mean"], 1.0 / 4);              // all records: errors 3, 0, -3, 4
  EXPECT_DOUBLE_EQ(found[2]["records"], 3.5);
  EXPECT_TRUE(found[0]["mse_of_product"].is_null());
  const auto exact = several_json(labels(), kAll, estimates, [](std::span<const std::size_t> rows) {
    return std::vector<double>{1.0, rows.size() < 3 ? 4.0 : 2.0};
  });
  EXPECT_DOUBLE_EQ(exact[0]["mse_of_product"], 2.0);
  EXPECT_DOUBLE_EQ(exact[1]["mse_of_product"], 0.0);
  EXPECT_TRUE(several_json(labels(), std::vector<std::uint64_t>{0, 1}, estimates).is_null());
}

}  // namespace
}  // namespace swingbank::train::run
