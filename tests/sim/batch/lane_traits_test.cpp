#include "sim/batch/detail/lane_traits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace swingbank::sim::batch {
namespace {

template <class T>
class LaneTraitsTest : public ::testing::Test {};
using Types = ::testing::Types<double, P4, P8, FloatPack>;
TYPED_TEST_SUITE(LaneTraitsTest, Types);

TYPED_TEST(LaneTraitsTest, MaximumKeepsANanOnEitherSide) {
  using Traits = LaneTraits<TypeParam>;
  const TypeParam nan(std::numeric_limits<double>::quiet_NaN()), one(1.0), two(2.0);
  EXPECT_EQ(Traits::get(maximum_or_nan(one, two), 0), 2.0);
  EXPECT_EQ(Traits::get(maximum_or_nan(two, one), 0), 2.0);
  EXPECT_TRUE(std::isnan(Traits::get(maximum_or_nan(nan, one), 0)));
  EXPECT_TRUE(std::isnan(Traits::get(maximum_or_nan(one, nan), 0)));
}

}  // namespace
}  // namespace swingbank::sim::batch
