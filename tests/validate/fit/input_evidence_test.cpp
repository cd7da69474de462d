// The evidence of an input that is free in time, against integrals that are worked out directly.
#include "validate/fit/detail/input_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace swingbank::validate::fit::fitting {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

/// An event with one state, believed within 20, whose residuals are `r`.
struct Example {
  MatrixXd by_z{{1.0, 0.2}, {0.5, -0.7}, {0.1, 0.4}, {-0.3, 0.9}};
  MatrixXd by_state;  ///< the state, then the knots
  VectorXd residuals{{2.0, -1.0, 3.0, 0.5}};
  VectorXd precision{{1 / 400.0}}, input;
  [[nodiscard]] double cost(double bend) const {
    InputEvidence e(VectorXd{{4.0, 25.0}}, VectorXd{{0.1, -0.2}});
    e.add(by_z, by_state, residuals, precision, input);
    return e.cost(bend);
  }
};

TEST(InputEvidence, AnInputThatDoesNothingIsWorthNothing) {
  Example with, without;
  without.by_state = VectorXd{{0.3, 0.3, 0.3, 0.3}};
  with.by_state = MatrixXd::Zero(4, 3);
  with.by_state.col(0) = without.by_state;
  with.input = VectorXd{{0.4, -0.1}};
  EXPECT_NEAR(with.cost(0.01), without.cost(0.01), 1e-9);
}
/// One knot, one state and nothing else: the integral of the likelihood over both, and over the bend's size.
TEST(InputEvidence, IsTheIntegralOfTheLikelihood) {
  const VectorXd residuals{{2.0, -1.0, 3.0}}, by_state{{0.3, 0.1, 0.2}}, by_knot{{40.0, -25.0, 55.0}};
  const double bend = 0.05, at = 0.02;
  MatrixXd slopes(3, 2);
  slopes << by_state, by_knot;
  InputEvidence e(VectorXd(0), VectorXd(0));
  e.add(MatrixXd(3, 0), slopes, residuals, VectorXd{{1 / 400.0}}, VectorXd{{at}});
  double integral = 0;
  int sizes = 0;
  for (int k = -12; k <= 2; ++k, ++sizes) {
    const double b = bend * std::pow(10.0, k / 4.0), step = 5e-3;
    for (double z = -8; z < 8; z += step) {  // in units of b
      const VectorXd r = residuals + by_knot * (b * z - at);
      // over the state, a Gaussian
      const double a = by_state.squaredNorm() + 1 / 400.0, g = by_state.dot(r);
      integral += std::exp(-0.5 * (r.squaredNorm() - g * g / a)) * std::exp(-0.5 * z * z) /
                  std::sqrt(2 * M_PI) * step;
    }
  }
  EXPECT_NEAR(e.cost(bend), -2 * std::log(integral / sizes), 1e-3);
}
/// Where the input must be small, it is not charged for what it could have been.
TEST(InputEvidence, ASmallInputPaysLessThanOneOfTheSizeBelieved) {
  const int knots = 30;
  MatrixXd slopes = MatrixXd::Zero(knots, knots + 1);
  slopes.rightCols(knots) = 1000 * MatrixXd::Identity(knots, knots);
  VectorXd input(knots), residuals(knots);
  for (int k = 0; k < knots; ++k) {
    input[k] = 0.005 * std::sin(0.2 * k);  // bends of 0.0002
    residuals[k] = k % 2 ? 1 : -1;
  }
  InputEvidence e(VectorXd(0), VectorXd(0));
  e.add(MatrixXd(knots, 0), slopes, residuals, VectorXd{{1.0}}, input);
  const double none = (residuals - slopes.rightCols(knots) * input).squaredNorm();
  EXPECT_LT(e.cost(0.01), none);                      // the input is there
  EXPECT_LT(e.cost(0.01), e.cost(10.0) - 2 * knots);  // bends of 0.01 to 30 are far too large
}

}  // namespace
}  // namespace swingbank::validate::fit::fitting
