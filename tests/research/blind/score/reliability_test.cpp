// Reliability of stated probabilities, computed by hand.
#include "research/blind/score/reliability.hpp"

#include <gmock/gmock.h>

namespace swingbank::research::blind::score {
namespace {

Forecast forecast(double first, bool right, bool listed = true) {
  return {"P, Q only", {first, 1 - first}, {static_cast<char>(right), static_cast<char>(!right)}, listed};
}

TEST(Reliability, CountsEightOfTenAsEightyPerCent) {
  std::vector<Forecast> all;
  for (int k = 0; k < 10; ++k) all.push_back(forecast(0.8, k < 8));
  const Reliability r = reliability(all);
  EXPECT_NEAR(r.error, 0, 1e-12);
  EXPECT_GT(r.error_high, 0);
  EXPECT_EQ(r.cases, 10);
  EXPECT_EQ(r.bins[4].right.hits, 8);  // 70 to 90 %
  EXPECT_EQ(r.bins[4].right.n, 10);
  EXPECT_NEAR(r.bins[4].mean, 0.8, 1e-12);
  EXPECT_EQ(r.bins[1].right.hits, 2);  // the second explanation, at 20 %
}
TEST(Reliability, ErrorIsMeanOverconfidence) {
  std::vector<Forecast> all;
  for (int k = 0; k < 20; ++k) all.push_back(forecast(0.95, k < 10));
  const Reliability r = reliability(all);
  EXPECT_NEAR(r.error, 0.45, 1e-12);
  EXPECT_LT(r.error_low, 0.45);
  EXPECT_GT(r.error_high, 0.45);
}
TEST(Reliability, SetSumsToNinetyFivePerCent) {
  const Reliability r = reliability({forecast(0.97, true), forecast(0.97, false), forecast(0.6, false),
                                     forecast(0.6, true, false)});  // the last truth is not in the list
  ASSERT_EQ(r.sets.size(), 1U);
  EXPECT_EQ(r.sets[0].second.coverage.n, 3);
  EXPECT_EQ(r.sets[0].second.coverage.hits, 2);
  EXPECT_NEAR(r.sets[0].second.mean_size, 4.0 / 3, 1e-12);
}
TEST(Reliability, IsEmpty_WithoutProbabilities) {
  EXPECT_EQ(reliability_markdown(reliability({Forecast{}})), "");
  EXPECT_THAT(reliability_markdown(reliability({forecast(0.8, true)})),
              testing::HasSubstr("| 70–90 % | 80 % | 100 % (1 of 1; 21–100 %) |"));
}

}  // namespace
}  // namespace swingbank::research::blind::score
