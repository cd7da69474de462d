#include "sim/core/pack.hpp"

#include <gtest/gtest.h>

#include <random>

#include "sim/core/float_pack.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim {
namespace {

template <class P>
class PackMath : public ::testing::Test {};
using Packs = ::testing::Types<P4, P8>;
TYPED_TEST_SUITE(PackMath, Packs);

TYPED_TEST(PackMath, SincosAgreesWithTheLibrary) {
  std::mt19937_64 random(1);
  for (const double reach : {1.0, 10.0, 1e3, 1e5}) {
    std::uniform_real_distribution<double> u(-reach, reach);
    for (int i = 0; i < 20000; ++i) {
      TypeParam a(0.0), s, c;
      for (int l = 0; l < TypeParam::lanes; ++l) a.set(l, u(random));
      sincos(a, s, c);
      for (int l = 0; l < TypeParam::lanes; ++l) {  // 2 ulp of 1
        ASSERT_NEAR(s[l], std::sin(a[l]), 4.5e-16) << a[l];
        ASSERT_NEAR(c[l], std::cos(a[l]), 4.5e-16) << a[l];
      }
    }
  }
}

TYPED_TEST(PackMath, Atan2AgreesWithTheLibraryInEveryQuadrant) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(-1.0, 1.0), e(-8.0, 3.0);
  for (int i = 0; i < 50000; ++i) {
    TypeParam x(0.0), y(0.0);
    for (int l = 0; l < TypeParam::lanes; ++l) {
      x.set(l, u(random) * std::pow(10.0, e(random)));
      y.set(l, u(random) * std::pow(10.0, e(random)));
    }
    const TypeParam r = atan2(y, x);
    for (int l = 0; l < TypeParam::lanes; ++l)
      ASSERT_NEAR(r[l], std::atan2(y[l], x[l]), 9e-16) << y[l] << " " << x[l];
  }
  EXPECT_EQ(atan2(TypeParam(0.0), TypeParam(0.0))[0], 0.0);
}

TYPED_TEST(PackMath, SelectTakesEachLaneByItself) {
  TypeParam a(1.0), b(2.0), x(0.0);
  x.set(1, 5.0);
  const TypeParam r = select(x > TypeParam(1.0), a, b);
  EXPECT_EQ(r[0], 2.0);
  EXPECT_EQ(r[1], 1.0);
}

TEST(FloatPackMath, AgreesWithTheLibrary) {
  std::mt19937_64 random(3);
  for (const double reach : {1.0, 10.0, 1e3, 1e4}) {
    std::uniform_real_distribution<double> u(-reach, reach);
    for (int i = 0; i < 20000; ++i) {
      FloatPack a(0.0), b(0.0), s, c;
      for (int l = 0; l < FloatPack::lanes; ++l) a.set(l, u(random)), b.set(l, u(random));
      sincos(a, s, c);
      const FloatPack angle = atan2(a, b), root = sqrt(a * a), whole = round_nearest(a);
      for (int l = 0; l < FloatPack::lanes; ++l) {
        ASSERT_NEAR(s[l], std::sin(double{a[l]}), 1.2e-7) << a[l];  // 2 ulp of 1
        ASSERT_NEAR(c[l], std::cos(double{a[l]}), 1.2e-7) << a[l];
        ASSERT_NEAR(angle[l], std::atan2(double{a[l]}, double{b[l]}), 4.8e-7) << a[l] << " " << b[l];
        ASSERT_NEAR(root[l], std::abs(a[l]), 1.2e-7 * std::abs(a[l]));
        ASSERT_EQ(whole[l], std::nearbyint(a[l]));
      }
    }
  }
  EXPECT_EQ(atan2(FloatPack(0.0), FloatPack(0.0))[0], 0.0F);
}

TEST(FloatPackMath, LanesAreIndependent) {
  FloatPack x(0.0), none(-1.0);
  x.set(9, 5.0);
  const FloatPack r = select(x > FloatPack(1.0), FloatPack(1.0), FloatPack(2.0));
  for (int l = 0; l < FloatPack::lanes; ++l) EXPECT_EQ(r[l], l == 9 ? 1.0F : 2.0F);
  EXPECT_TRUE(any_positive(x));
  EXPECT_FALSE(any_positive(none));
}

}  // namespace
}  // namespace swingbank::sim
