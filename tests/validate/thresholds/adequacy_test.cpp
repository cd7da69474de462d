// The criterion that decides whether a model is adequate, at its limit and next to it.
#include "validate/thresholds/adequacy.hpp"

#include <gmock/gmock.h>

#include "base/json.hpp"
#include "validate/thresholds/list.hpp"

namespace swingbank::validate::thresholds {
namespace {

struct Event {
  std::string record;
  double after, limit;
};

TEST(Adequacy, OneBinBeyondItsBoundIsEnough) {
  EXPECT_TRUE(judged_by_bins(0, 405).adequate);
  const Ruling one = judged_by_bins(1, 405);
  EXPECT_FALSE(one.adequate);
  EXPECT_EQ(one.by, Criterion::bins);
  EXPECT_DOUBLE_EQ(one.value, 1);
  EXPECT_EQ(one.where, "of 405");
}

TEST(Adequacy, EventLimitIsAtLeastTheInterpolationError) {
  EXPECT_DOUBLE_EQ(event_limit(0.01, 1.12), 1.12);
  EXPECT_DOUBLE_EQ(event_limit(0.1, 1.12), 1 + 3.09 * 0.1);
}

TEST(Adequacy, EventWithTheLargestRatioToItsLimitDecides) {
  const std::vector<Event> events = {{"a", 1.19, 1.2}, {"b", 1.14, 1.12}, {"c", 1.3, 1.4}};
  const Ruling ruling = judged_by_events(events);
  EXPECT_FALSE(ruling.adequate);
  EXPECT_EQ(ruling.where, "b");
  EXPECT_DOUBLE_EQ(ruling.value, 1.14);
  EXPECT_DOUBLE_EQ(ruling.limit, 1.12);
  EXPECT_TRUE(judged_by_events(std::vector<Event>{{"a", 1.2, 1.2}}).adequate);
  EXPECT_FALSE(judged_by_events(std::vector<Event>{{"b", 1.14, 1.12}, {"a", 1.1, 1.2}}).adequate);
}

TEST(Adequacy, IncomparableEventIsInadequate) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(judged_by_events(std::vector<Event>{{"a", nan, 1.2}, {"b", 1.0, 1.2}}).adequate);
}

TEST(Adequacy, DiagnoseNamesTheFirstCriterionThatFails) {
  const Refitted good{.reduced_chi2 = 1.12, .slow = 7.9, .line = 39, .torque = 0, .field = 39};
  const auto by = [](Refitted r) { return judged_by_remainder(r, adequacy.reduced_chi2); };
  EXPECT_TRUE(by(good).adequate);
  EXPECT_EQ(by(good).by, Criterion::reduced_chi2);
  Refitted r = good;
  r.reduced_chi2 = 1.13;
  EXPECT_EQ(by(r).by, Criterion::reduced_chi2);
  EXPECT_FALSE(by(r).adequate);
  r = good;
  r.slow = 8;
  EXPECT_EQ(by(r).by, Criterion::slow);
  EXPECT_FALSE(by(r).adequate);
  r = good;
  r.line = 41;
  EXPECT_EQ(by(r).by, Criterion::line);
  EXPECT_FALSE(by(r).adequate);
  r = good;
  r.field = 41;
  EXPECT_EQ(by(r).by, Criterion::free_input);
  EXPECT_EQ(by(r).where, "field voltage");
  EXPECT_FALSE(by(r).adequate);
}

TEST(Adequacy, NamedEffectIsJudgedByItsEvidence) {
  const Ruling ruling = judged_by_evidence("SEXS", 1234.5);
  EXPECT_FALSE(ruling.adequate);
  EXPECT_EQ(ruling_json(ruling).at("criterion"), "named_effect");
  EXPECT_EQ(ruling_json(ruling).at("limit"), evidence.accepted.value);
}

}  // namespace
}  // namespace swingbank::validate::thresholds
