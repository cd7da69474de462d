#include "base/white_noise.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace swingbank {
namespace {

TEST(WhiteVariance, IgnoresALinearTrend) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, 0.3);
  std::vector<double> x;
  for (int k = 0; k < 20000; ++k) x.push_back(5.0 + 0.1 * k + normal(random));
  // relative standard error for n values is sqrt(35 / 9 / n): 1.4 % here
  EXPECT_NEAR(white_variance(x), 0.09, 3 * 0.014 * 0.09);
}
TEST(WhiteVariance, NeedsThreeValues) {
  EXPECT_EQ(white_variance(std::vector<double>{1.0, 2.0}), 0.0);
  EXPECT_EQ(white_variance(std::vector<double>{}), 0.0);
  EXPECT_DOUBLE_EQ(white_variance(std::vector<double>{0.0, 1.0, 0.0}), 4.0 / 6);
}

}  // namespace
}  // namespace swingbank
