// A search that ends at a bound goes on along it.
#include "validate/fit/detail/at_bounds.hpp"

#include <gtest/gtest.h>

namespace swingbank::validate::fit::fitting {
namespace {

/// 100 (x - y + z) and x + y - 4: with x at its bound of 1 both vanish at y = 3, z = 2.
struct Valley {
  template <class T>
  bool operator()(const T* at, T* left) const {
    left[0] = T(100) * (at[0] - at[1] + at[2]);
    left[1] = at[0] + at[1] - T(4);
    return true;
  }
};
double solve(ceres::Problem& problem) {
  ceres::Solver::Options o;
  o.function_tolerance = 1e-3;  // each step along the cut direction gains a ten-thousandth
  o.max_num_line_search_step_size_iterations = 0;
  o.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(o, &problem, &summary);
  return summary.final_cost;
}

TEST(AtBounds, WhatIsDrawnBeyondABoundIsHeldThere) {
  double at[3] = {1, 1, 0};
  ceres::Problem problem;
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Valley, 2, 3>(new Valley), nullptr, at);
  problem.SetParameterUpperBound(at, 0, 1.0);
  AtBounds bounds(problem);
  bounds.fix(at, {});
  ASSERT_GT(solve(problem), 1.0) << "the bound was meant to stop the search";
  ASSERT_TRUE(bounds.hold());
  EXPECT_LT(solve(problem), 1e-9);
  EXPECT_NEAR(at[1], 3, 1e-6);
  EXPECT_FALSE(bounds.hold()) << "the same is held";
}
TEST(AtBounds, WhatNeverMovesStays) {
  double at[3] = {0.5, 1, 0};
  ceres::Problem problem;
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Valley, 2, 3>(new Valley), nullptr, at);
  problem.SetParameterUpperBound(at, 1, 2.0);
  AtBounds bounds(problem);
  bounds.fix(at, {0});
  solve(problem);
  EXPECT_EQ(at[0], 0.5);
  bounds.hold();
  solve(problem);
  bounds.release();
  solve(problem);
  EXPECT_EQ(at[0], 0.5);
}

}  // namespace
}  // namespace swingbank::validate::fit::fitting
