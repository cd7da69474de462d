// Quadratic machine saturation through its two factors, also where they differ little.
#include "sim/core/saturation.hpp"

#include <gtest/gtest.h>

namespace swingbank::sim {
namespace {

double field_demand(double s10, double s12, double psi) {
  double a = 0.0, b = 0.0;
  QuadraticSaturation::prepare(s10, s12, a, b);
  return psi * QuadraticSaturation::factor(a, b, psi * psi);
}

TEST(QuadraticSaturation, PassesThroughBothFactors) {
  for (const auto& [s10, s12] : {std::pair{0.1, 0.4}, {0.05, 0.6}, {1.01, 1.02}, {0.3, 0.36}}) {
    EXPECT_NEAR(field_demand(s10, s12, 1.0), s10, 1e-12) << s10;
    EXPECT_NEAR(field_demand(s10, s12, 1.2), 1.2 * s12, 1e-12) << s10;
  }
}

// psi Se = B (psi - A)^2 through (1, S1.0) and (1.2, 1.2 S1.2): sqrt(1.2 S1.2/S1.0) = (1.2 - A)/(1 - A). If
// S1.2 < 1.2 S1.0, the vertex A lies below zero. The field current then exceeds the air-gap line at every
// flux, by B A^2 at the smallest flux. The other root for A, (1.2 + r)/(1 + r), lies between the two points.
// Its curve would fall from 1 to A and is not a saturation curve.
TEST(QuadraticSaturation, FactorsThatHardlyDifferPutTheVertexBelowZero) {
  const double r = std::sqrt(1.2 * 1.02 / 1.01), A = (1.2 - r) / (1.0 - r),
               B = 1.01 / ((1.0 - A) * (1.0 - A));
  ASSERT_LT(A, 0.0);
  double a = 0.0, b = 0.0;
  QuadraticSaturation::prepare(1.01, 1.02, a, b);
  EXPECT_NEAR(a, A, 1e-12);
  EXPECT_NEAR(b, B, 1e-12);
  for (const double psi : {0.05, 0.3, 0.7}) {
    EXPECT_NEAR(field_demand(1.01, 1.02, psi), B * (psi - A) * (psi - A), 1e-12) << psi;
    EXPECT_GT(field_demand(1.01, 1.02, psi), 0.24) << psi;
  }
  // Field demand at the smallest flux: 0.248 pu.
  EXPECT_NEAR(field_demand(1.01, 1.02, 1e-9), B * A * A, 1e-6);
  EXPECT_GT(field_demand(0.3, 0.37, 1e-9), -1e-12);  // vertex above zero: no saturation below it
  EXPECT_EQ(field_demand(0.3, 0.37, 1e-6), 0.0);
}

TEST(QuadraticSaturation, ZeroFactorAtRatedFluxMeansNoSaturation) {
  EXPECT_EQ(field_demand(0.0, 1.0, 1.2), 0.0);
  EXPECT_FALSE(QuadraticSaturation::possible(1.0, 0.8));
}

}  // namespace
}  // namespace swingbank::sim
