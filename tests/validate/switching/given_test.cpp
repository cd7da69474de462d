// Switching times given by the user, and the opening time of a breaker.
#include "validate/switching/given.hpp"

#include <gmock/gmock.h>

#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::switching {
namespace {

TEST(BreakerTimes, IsTheStepNearestToTheGivenTime) {
  record::Record r;
  for (int k = 0; k < 100; ++k) r.t.push_back(0.02 * k);
  r.staged = {{record::StagedEvent::Kind::load_rejection, 1.0}};
  EXPECT_EQ(breaker_times(r, {{.time = 0.3}, {.time = 1.03, .uncertainty = 0.01}}).front().time, 1.03);
  EXPECT_EQ(breaker_times(r, {{.time = 0.3}}).front().time, 1.0);
  for (const double t : r.t) r.P.push_back(t < 1.03 ? 0.8 : 0.0);
  EXPECT_NEAR(breaker_times(r, {}).front().time, 1.03, 1e-12);
  EXPECT_NEAR(breaker_times(r, {}).front().uncertainty, 0.01, 1e-12);
  r.component = record::Component::exciter;  // has no connection to the grid
  EXPECT_EQ(r.breaker(), nullptr);
}
TEST(GivenSwitchingTimes, AreSortedByRecord) {
  const auto times = given_switching_times({"b.csv=2.1", "a.csv=1", "b.csv=2"}, {"x/a.csv", "x/b.csv"});
  EXPECT_EQ(times.at("a.csv"), std::vector<double>{1.0});
  EXPECT_EQ(times.at("b.csv"), (std::vector<double>{2.0, 2.1}));
  record::Record r;
  r.switched = times.at("b.csv");
  ASSERT_EQ(given_times(r).size(), 2U);
  EXPECT_EQ(given_times(r)[1].time, 2.1);
  EXPECT_EQ(given_times(r)[1].uncertainty, 0);
}
TEST(GivenSwitchingTimes, RefusesEveryInvalidWord) {
  EXPECT_THAT(test::messages([] {
                given_switching_times({"soon", "2.0", "c.csv=2.0"}, {"a.csv", "b.csv"});
              }),
              ::testing::SizeIs(3));
}

}  // namespace
}  // namespace swingbank::validate::switching
