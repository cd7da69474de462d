// Probabilities from log evidences, computed by hand.
#include "validate/hypothesis/posterior.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::hypothesis {
namespace {

constexpr double kNone = -1e6;  ///< evidence of an input that explains nothing

double of(const std::vector<Explanation>& all, const std::string& name) {
  const auto at = std::ranges::find(all, name, &Explanation::name);
  return at == all.end() ? -1 : at->probability;
}

TEST(Posterior, EqualEvidencesHaveEqualProbabilities) {
  const auto all = posterior({{kNothingMissing, 0}, {"A", 400, 0}, {"B", 400, 1}}, kNone);
  const double scale = 2 * thresholds::posterior.scale;
  const double outside = std::exp(-thresholds::evidence.accepted / scale), nothing = std::exp(-400 / scale);
  EXPECT_NEAR(of(all, "A"), 1 / (2 + outside + nothing), 1e-12);
  EXPECT_DOUBLE_EQ(of(all, "A"), of(all, "B"));
  EXPECT_NEAR(of(all, kNoneOfThese), outside / (2 + outside + nothing), 1e-12);
}
TEST(Posterior, SumsToOneInDescendingOrder) {
  const auto all = posterior({{kNothingMissing, 0}, {"A", 60, 0}, {"B", 75, 1}, {"C", -30, 2}}, kNone);
  double sum = 0;
  for (const auto& e : all) sum += e.probability;
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_EQ(all.front().name, "B");
  EXPECT_EQ(all.size(), 5U);
}
TEST(Posterior, OddsFollowFromTheDifferenceOfEvidences) {
  const auto all = posterior({{"A", 100, 0}, {"B", 100 - 2 * thresholds::posterior.scale, 1}}, kNone);
  EXPECT_NEAR(of(all, "A") / of(all, "B"), std::exp(1), 1e-12);
}
TEST(Posterior, PrefersNoneOfThese_WhenAFreeInputExplainsMore) {
  const auto all = posterior({{kNothingMissing, 0}, {"A", 60, 0}}, 400);
  EXPECT_EQ(all.front().name, kNoneOfThese);
  EXPECT_GT(all.front().probability, 0.99);
}
TEST(Posterior, FallsBackToNothingMissing) {
  const auto all = posterior({{kNothingMissing, 0}, {"A", -60, 0}, {"B", -85, 1}}, -250);
  EXPECT_EQ(all.front().name, kNothingMissing);
  EXPECT_GT(all.front().probability, 0.99);
}
TEST(Posterior, SetSumsToNinetyFivePerCent) {
  const auto with = [](std::vector<double> shares) {
    std::vector<Explanation> all;
    for (const double p : shares) all.push_back({"", 0, 0, p});
    return credible(all);
  };
  EXPECT_EQ(with({0.96, 0.04}), 1U);
  EXPECT_EQ(with({0.94, 0.04, 0.02}), 2U);
  EXPECT_EQ(with({0.4, 0.3, 0.2, 0.1}), 4U);
  EXPECT_EQ(with({}), 0U);
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
