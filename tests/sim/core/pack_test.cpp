#include "sim/core/pack.hpp"

#include <gtest/gtest.h>

#include <random>

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

}  // namespace
}  // namespace swingbank::sim
