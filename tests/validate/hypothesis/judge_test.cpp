// Objections to an effect from events outside the fit.
#include "validate/hypothesis/judge.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "tests/validate/fit/exciter_example.hpp"

namespace swingbank::validate::hypothesis {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kAdequate = thresholds::adequacy.reduced_chi2;

/// An event of 1,000 values whose cost per value goes from `before` to `after`.
HeldOut event(const std::string& name, double before, double after) {
  HeldOut h;
  h.record = name;
  h.values = 1000;
  h.before = h.cost_before = before;
  h.after = h.cost_after = after;
  return h;
}

TEST(Objection, NoneWhenEveryEventIsPredicted) {
  EXPECT_THAT(objection({event("a", 3.0, 1.0), event("b", 1.2, 1.01)}, 2000, kAdequate), IsEmpty());
}
TEST(Objection, AllowsScatterOfAnUnaffectedEvent) {
  EXPECT_THAT(objection({event("a", 3.0, 1.0), event("b", 1.0, 1.01)}, 2000, kAdequate), IsEmpty());
}
TEST(Objection, RefusesImprovementAtTheCostOfAnEvent) {
  EXPECT_NEAR(event("b", 1.0, 1.03).saves(), -30, 1e-9);
  // The event's chi2 rises by 30, which is above 20 and above 10 % of this evidence.
  EXPECT_THAT(objection({event("a", 1.2, 1.0), event("b", 1.0, 1.03)}, 200, kAdequate),
              HasSubstr("increases the error of held-out b"));
  // The rise is below 10 % of this evidence, and the event's residual is still noise.
  EXPECT_THAT(objection({event("a", 3.0, 1.0), event("b", 1.0, 1.03)}, 2000, kAdequate), IsEmpty());
}
TEST(Objection, RefusesDeteriorationOfABadEvent) {
  EXPECT_THAT(objection({event("a", 30.0, 1.0), event("b", 2.0, 2.1)}, 29000, kAdequate),
              HasSubstr("increases the error of held-out b"));
}
TEST(Objection, EventIsNotPredicted_WhenTheFitWithoutItFails) {
  HeldOut none = event("b", 1.0, 1.0);
  none.cost_after = std::numeric_limits<double>::infinity();
  EXPECT_THAT(objection({event("a", 3.0, 1.0), none}, 2000, kAdequate),
              HasSubstr("increases the error of held-out b"));
}
TEST(HeldOutEvents, FailedFitPredictsNothing) {
  fit::ExciterExample example(0.2);
  example.events = example.events.only({0, 0});
  const fit::Fit whole = example.fitted({"H"}, {.iterations = 0});
  const Trial trial{example.events, 0.2, kAdequate};
  const auto test_unseen = [&](const fit::Fit& f) {
    return hold_out(trial, example.model.under_test(), example.free({"H", "EMAX"}), f);
  };
  EXPECT_LT(test_unseen(whole).front().cost_after, 1e6);
  fit::Fit impossible = whole;
  for (const auto& f : example.free({"EMAX"}))
    sim::plant::parameter_value(impossible.plant, f.id) = 0.5;  // below the initial Efd
  EXPECT_GT(test_unseen(impossible).front().cost_after, 1e300);
}
TEST(Objection, RequiresPredictionNotOnlyImprovement) {
  EXPECT_THAT(objection({event("a", 3.0, 1.0), event("b", 3.0, 1.5)}, 3500, kAdequate),
              HasSubstr("predict held-out b"));
  // A tenth of the former error suffices; the reduced chi-square is judged separately.
  EXPECT_THAT(objection({event("a", 3.0, 1.0), event("b", 30.0, 1.5)}, 30000, kAdequate), IsEmpty());
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
