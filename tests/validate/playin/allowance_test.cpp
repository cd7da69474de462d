// The factor by which the integration error of a state may exceed the tolerance, given its effect on the
// compared channels.
#include "validate/playin/allowance.hpp"

#include <gtest/gtest.h>

namespace swingbank::validate::playin {
namespace {

constexpr double kInterval = 1.0 / 60;

/// States: 0: a slow state, observed in P; 1: a lag of 0.02 s that drives state 0 with a time constant of 6
/// s; 2: a lag that drives it with 0.2 s; 3: an unobservable state; 4: a state that hardly drives state 0.
LinearPlant plant() {
  LinearPlant p;
  p.A = Eigen::MatrixXd::Zero(5, 5);
  p.A(0, 0) = -1 / 6.0;
  p.A(0, 1) = 1 / 6.0;
  p.A(1, 1) = -1 / 0.02;
  p.A(0, 2) = 1 / 0.2;
  p.A(2, 2) = -1 / 0.02;
  p.A(3, 3) = -1 / 0.02;
  p.A(0, 4) = 1e-3;
  p.A(4, 4) = -1 / 0.02;
  p.C = Eigen::MatrixXd::Zero(kOutputs, 5);
  p.C(static_cast<int>(Output::P), 0) = 1;
  p.C(static_cast<int>(Output::Efd), 1) = 2;
  return p;
}

TEST(Allowances, FollowTheSensitivityOfTheComparedChannels) {
  const auto all = allowances(plant(), std::vector{Output::P}, kInterval);
  ASSERT_EQ(all.size(), 5U);
  EXPECT_EQ(all[0], 1.0);
  // Of an error of state 1, a fraction of 0.02 s / 6 s reaches state 0; of an error of state 2, 0.02 s / 0.2
  // s.
  EXPECT_EQ(all[1], kMostAllowance);
  EXPECT_NEAR(all[2], 0.2 / 0.02, 1.5);
  EXPECT_EQ(all[3], 1.0) << "a state that is unobservable at the start may act once a limit is reached";
  EXPECT_EQ(all[4], kMostAllowance);
}
TEST(Allowances, AreSmallestForAComparedState) {
  const auto all = allowances(plant(), std::vector{Output::P, Output::Efd}, kInterval);
  EXPECT_EQ(all[1], 1.0);
  EXPECT_NEAR(all[2], 0.2 / 0.02, 1.5);
}
TEST(Allowances, AreOne_WhenTheLinearPlantIsUnknown) {
  LinearPlant unknown = plant();
  unknown.A(0, 0) = std::nan("");
  EXPECT_EQ(allowances(unknown, std::vector{Output::P}, kInterval), std::vector(5, 1.0));
}

}  // namespace
}  // namespace swingbank::validate::playin
