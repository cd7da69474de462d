// Allowance for parameter errors in the chi-square limit of an event outside the fit. The limit is exceeded
// once in a thousand, and the verdict names an event that is accepted only because of the allowance.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "validate/calibrate/calibrate.hpp"

namespace swingbank::validate::calibrate {
namespace {

// Three parameters with very different errors change 200 values, whose noise is 1. A normal variable exceeds
// 3.09 once in a thousand; a quadratic form of few squares does so more often.
TEST(UnseenAllowance, IsExceededRarelyButNotNever) {
  constexpr int kValues = 200, kParameters = 3, kDraws = 20000;
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd jacobian(kValues, kParameters);
  for (double& x : jacobian.reshaped()) x = normal(generator);
  const Eigen::Vector3d deviation(1.0, 0.1, 0.01);
  const Eigen::MatrixXd covariance = deviation.cwiseAbs2().asDiagonal();
  const double allowed = unseen_allowance(jacobian.transpose() * jacobian, covariance, kValues);
  int beyond = 0;
  double mean = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd moved(kParameters), noise(kValues);
    for (int k = 0; k < kParameters; ++k) moved[k] = deviation[k] * normal(generator);
    for (double& x : noise) x = normal(generator);
    const double added = ((jacobian * moved + noise).squaredNorm() - noise.squaredNorm()) / kValues;
    mean += added / kDraws;
    beyond += added > allowed;
  }
  EXPECT_LT(beyond, kDraws / 50);  // for one square, 2.1 % lie beyond 3.09 deviations: z^2 > 1 + 3.09 sqrt(2)
  EXPECT_GT(beyond, 0);            // the limit is reachable
  EXPECT_GT(allowed, 2 * mean);
}

TEST(UnseenAllowance, IsZero_WhenTheParametersAreKnown) {
  const Eigen::MatrixXd information = Eigen::MatrixXd::Identity(4, 4);
  EXPECT_EQ(unseen_allowance(information, Eigen::MatrixXd::Zero(4, 4), 100), 0);
}

TEST(ResidualText, NamesTheEventThatOnlyTheAllowanceAccepts) {
  EventScore seen{.record = "a.csv", .after = 1.1, .limit = 1.2, .channels = {}};
  EventScore held_out{
      .record = "b.csv", .seen = false, .after = 5.08, .limit = 18.2, .allowance = 16.9, .channels = {}};
  EXPECT_TRUE(held_out.adequate());
  EXPECT_FALSE(held_out.is_noise());
  EXPECT_EQ(residual_text({seen}), "the residual is noise");
  EXPECT_EQ(
      residual_text({seen, held_out}),
      "the residual is within noise and the uncertainty of the fitted parameters (b.csv: reduced chi-square "
      "5.08, limit 18.2, for noise alone 1.3)");
  held_out.after = 1.25;
  EXPECT_EQ(residual_text({seen, held_out}), "the residual is noise");
}

}  // namespace
}  // namespace swingbank::validate::calibrate
