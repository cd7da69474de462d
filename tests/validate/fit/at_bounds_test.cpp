// A search that reaches a bound continues along it.
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
/// The valley from (x, 1, 0), with an upper bound on one of the three variables and some fixed ones.
struct Bounded {
  double at[3];
  ceres::Problem problem;
  AtBounds bounds{problem};
  Bounded(double x, int which, double bound, std::vector<int> fixed) : at{x, 1, 0} {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Valley, 2, 3>(new Valley), nullptr, at);
    problem.SetParameterUpperBound(at, which, bound);
    bounds.fix(at, std::move(fixed));
  }
  double solve() {
    ceres::Solver::Options o;
    o.function_tolerance = 1e-3;  // a step that is clipped at the bound reduces the cost by only 1e-4
    o.max_num_line_search_step_size_iterations = 0;
    o.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(o, &problem, &summary);
    return summary.final_cost;
  }
};

TEST(AtBounds, ContinuesAlongTheBound) {
  Bounded valley(1, 0, 1.0, {});
  ASSERT_GT(valley.solve(), 1.0) << "the bound must stop the first search";
  ASSERT_TRUE(valley.bounds.activate());
  EXPECT_LT(valley.solve(), 1e-9);
  EXPECT_NEAR(valley.at[1], 3, 1e-6);
  EXPECT_FALSE(valley.bounds.activate()) << "the active set must not change";
}
TEST(AtBounds, KeepsFixedParameters) {
  Bounded valley(0.5, 1, 1.0, {0});
  valley.solve();
  EXPECT_EQ(valley.at[0], 0.5);
  ASSERT_TRUE(valley.bounds.activate());
  valley.solve();
  valley.bounds.release();
  valley.solve();
  EXPECT_EQ(valley.at[0], 0.5);
}

}  // namespace
}  // namespace swingbank::validate::fit::fitting
