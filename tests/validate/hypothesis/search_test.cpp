// Effects tried in addition to a structure, and in place of a part of it.
#include "validate/hypothesis/search.hpp"

#include <gmock/gmock.h>

#include "sim/library/library.hpp"
#include "tests/validate/fit/exciter_example.hpp"
#include "tests/validate/hypothesis/hidden_exciter.hpp"

namespace swingbank::validate::hypothesis {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::Not;

using WholeFit = HiddenExciter;

/// An armature resistance that the model lacks.
TEST_F(WholeFit, FindsParameterAtItsNullValue) {
  Hypothesis truth = named("GENROU:Ra");
  constexpr double kRa = 0.03;
  sim::plant::parameter_value(truth.plant, truth.free.front().id) = kRa;
  record_response_of(truth.under_test());
  base_ = fit::fit(model_.under_test(), events_, fit::free_parameters(model_.plant, base_model_.prior_sd));
  const auto tried = try_hypotheses(base_model_, {named("PTERROR"), truth});
  ASSERT_EQ(tried.size(), 2U);
  EXPECT_EQ(tried.front().hypothesis.name, "GENROU:Ra");
  EXPECT_GT(tried.front().gain, thresholds::evidence.accepted);
  const fit::FittedParameter& Ra = tried.front().fit.parameters.back();
  EXPECT_NEAR(Ra.value, kRa, 3 * Ra.error);
  EXPECT_EQ(tried.back().hypothesis.name, "PTERROR");
}

/// An ordinary fit from KF = 0 does not find a fast rate feedback.
TEST_F(WholeFit, FindsRateFeedbackInactiveByDefault) {
  constexpr double kKF = 0.05, kTF = 0.1;  // [pu], [s]; a slow feedback is equivalent to a lead-lag
  const Hypothesis exst1 = named("EXST1");
  Hypothesis truth = exst1;
  parameter(truth.plant, "KF") = kKF;
  parameter(truth.plant, "TF") = kTF;
  record_response_of(truth.under_test());
  const auto alone = try_hypotheses(base_model_, {exst1});
  ASSERT_EQ(alone.size(), 1U);
  const auto tried = try_hypotheses(base_model_, with_left_off(exst1, alone.front().fit.plant));
  ASSERT_EQ(tried.size(), 1U);
  EXPECT_EQ(tried.front().hypothesis.name, "EXST1 with KF");
  EXPECT_GT(tried.front().gain, alone.front().gain + 100);
  for (const auto& [name, true_value] : {std::pair("KF", kKF), std::pair("TF", kTF)}) {
    const auto& parameters = tried.front().fit.parameters;
    const auto p = std::ranges::find(parameters, name, &fit::FittedParameter::name);
    ASSERT_NE(p, parameters.end()) << name;
    EXPECT_NEAR(p->value, true_value, 3 * p->error) << name;
  }
}

class Exchange : public ::testing::Test {
 protected:
  [[nodiscard]] static Hypothesis named(const std::vector<Hypothesis>& all, const std::string& name) {
    const auto found = std::ranges::find(all, name, &Hypothesis::name);
    if (found == all.end()) throw std::runtime_error("no hypothesis " + name);
    return *found;
  }
  /// Judgement of the effect `name`, added alone to the model, with its first parameter fitted to `value`.
  [[nodiscard]] Judgement alone(const std::string& name, double value) const {
    Judgement j;
    j.hypothesis = named(all_hypotheses(model().under_test(), model().library), name);
    j.fit = base_;
    j.fit.plant = j.hypothesis.plant;
    const fit::FreeParameter& f = j.hypothesis.free.front();
    sim::plant::parameter_value(j.fit.plant, f.id) = value;
    return j;
  }
  /// Judgement of the effect `second`, added to the model that contains the fitted effect `first`.
  [[nodiscard]] Judgement beside(const Judgement& first, const std::string& second, double value) const {
    const BaseModel then = after(base_model_, first);
    Judgement j;
    j.hypothesis = named(all_hypotheses(then.under_test(), then.library), second);
    j.fit = base_;
    j.fit.plant = j.hypothesis.plant;
    const fit::FreeParameter& f = j.hypothesis.free.front();
    sim::plant::parameter_value(j.fit.plant, f.id) = value;
    bring(then, j.hypothesis);
    return j;
  }
  [[nodiscard]] static std::vector<std::string> names(const std::vector<Judgement>& list) {
    std::vector<std::string> all;
    for (const auto& j : list) all.push_back(full_name(j.hypothesis));
    return all;
  }
  [[nodiscard]] const plant::PlantModel& model() const { return example_.model; }
  const fit::ExciterExample example_{0.2};
  const fit::Fit base_ = example_.fitted({"H"}, {.iterations = 0});
  const BaseModel base_model_{.events = example_.events,
                              .plant = example_.model.plant,
                              .conventions = example_.model.conventions,
                              .library = example_.model.library,
                              .fit = base_};
};

TEST_F(Exchange, StopsAmongSecondEffectsToo) {
  BaseModel base_model = base_model_;
  base_model.stop = [] { return true; };
  const Judgement first = alone("TGOV1", 0.06);
  const BaseModel then = after(base_model, first);
  for (const Judgement& j : try_hypotheses(then, then.hypotheses())) EXPECT_FALSE(j.fitted);
}

TEST_F(Exchange, KeepsTheFittedSecondEffectBesideTheSlotsCompetitors) {
  const Judgement pair = beside(alone("TGOV1", 0.06), "STEPUP", 0.07);
  const auto competitors = exchanges(base_model_, pair, {});
  EXPECT_THAT(names(competitors),
              testing::UnorderedElementsAre("STEPUP + DEGOV1", "STEPUP + GAST", "STEPUP + GGOV1",
                                            "STEPUP + HYGOV", "STEPUP + IEEEG1"));
  for (const Judgement& j : competitors) {
    EXPECT_FALSE(j.fit.failed.empty());
    // The prior mean is the value before any fit. The start is the value at the end of the pair's fit.
    const sim::plant::ParameterId own = pair.hypothesis.free.front().id;
    const auto id = sim::plant::same_parameter(j.hypothesis.plant, pair.hypothesis.plant, own).value();
    EXPECT_EQ(sim::plant::block_effect(j.hypothesis.plant, id.block).name, "STEPUP");
    const auto at = std::ranges::find(j.hypothesis.free, id, &fit::FreeParameter::id);
    ASSERT_NE(at, j.hypothesis.free.end());
    EXPECT_EQ(sim::plant::parameter_value(j.fit.plant, id), 0.07);
    EXPECT_EQ(sim::plant::parameter_value(j.hypothesis.plant, id),
              sim::plant::parameter_value(pair.hypothesis.plant, own));
    for (const auto& start : j.hypothesis.starts)
      EXPECT_EQ(start[static_cast<std::size_t>(at - j.hypothesis.free.begin())], 0.07);
  }
}
TEST_F(Exchange, KeepsSingleEffectsAmongTheHypotheses) {
  const Judgement pair = beside(alone("TGOV1", 0.06), "STEPUP", 0.07);
  Judgement accepted = alone("CTERROR", 0.01), rejected = alone("PTERROR", 0.01);
  accepted.accepted = true;
  const auto competitors = exchanges(base_model_, pair, {accepted, rejected});
  EXPECT_THAT(names(competitors), Contains("STEPUP + CTERROR"));
  EXPECT_THAT(names(competitors), Not(Contains("STEPUP + PTERROR")));
  const auto found =
      std::ranges::find(competitors, "CTERROR", [](const Judgement& j) { return j.hypothesis.name; });
  ASSERT_NE(found, competitors.end());
  const fit::FreeParameter& f = found->hypothesis.free.front();
  EXPECT_EQ(sim::plant::parameter_value(found->fit.plant, f.id), 0.01);
}
TEST_F(Exchange, DropsEffectsWithoutTheirPrerequisite) {
  Judgement pair = beside(alone("TGOV1", 0.06), "TGOV1:db", 0.001);
  EXPECT_THAT(exchanges(base_model_, pair, {}), IsEmpty());
}

class Crossing : public Exchange {
 protected:
  /// Judgement of a pair with these names and the log evidence `gain`.
  [[nodiscard]] static Judgement pair(const std::string& with, const std::string& name, double gain) {
    Judgement j;
    j.hypothesis.with = with;
    j.hypothesis.name = name;
    j.gain = gain;
    return j;
  }
};
TEST_F(Crossing, AddsReductionsOfTwoEffects) {
  std::vector<Judgement> pairs = {pair("GGOV1", "IEEET1", 100), pair("EXAC1", "GGOV1", 80),
                                  pair("EXAC1", "IEEEG1", 75), pair("EXAC1", "HYGOV", 60)};
  const auto best = best_cross(pairs);
  ASSERT_TRUE(best);
  EXPECT_EQ(best->joins + " joins " + best->stays, "IEEET1 joins IEEEG1");
  EXPECT_EQ(best->joins_in, &pairs[0]);
  EXPECT_EQ(best->stays_in, &pairs[2]);
  EXPECT_EQ(best->expected, 95);
  pairs.push_back(pair("IEEEG1", "IEEET1", 130));  // now the best pair, so HYGOV is tried beside it
  const auto next = best_cross(pairs);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->joins + " joins " + next->stays, "IEEET1 joins HYGOV");
  EXPECT_EQ(next->expected, 130 + 60 - 75);
}
TEST_F(Crossing, ExpectsNothing_WhenThePartnersWereNeverPaired) {
  EXPECT_FALSE(best_cross(std::vector{pair("GGOV1", "IEEET1", 100), pair("EXAC1", "IEEEG1", 75)}));
  EXPECT_FALSE(best_cross(std::vector{pair("GGOV1", "IEEET1", 100), pair("GGOV1", "EXAC1", 75)}));
}
TEST_F(Crossing, DoesNotRetryFailedPair) {
  std::vector<Judgement> pairs = {pair("GGOV1", "IEEET1", 100), pair("EXAC1", "GGOV1", 80),
                                  pair("EXAC1", "IEEEG1", 75), pair("IEEEG1", "IEEET1", 0)};
  pairs.back().fit.failed = "too steep";
  EXPECT_FALSE(best_cross(pairs));
}
TEST_F(Crossing, StartsEachEffectFromItsPair) {
  const std::vector<Judgement> pairs = {beside(alone("STEPUP", 0.07), "IEEEG1", 0.08),
                                        beside(alone("TGOV1", 0.06), "CTERROR", 0.01)};
  const Judgement j = crossed(base_model_, {"IEEEG1", &pairs[0], "CTERROR", &pairs[1], 0});
  EXPECT_EQ(full_name(j.hypothesis), "CTERROR + IEEEG1");
  EXPECT_EQ(sim::plant::parameter_value(j.fit.plant, j.hypothesis.free.front().id), 0.08);
  const fit::FreeParameter& stays = pairs[1].hypothesis.free.front();
  const auto id = sim::plant::same_parameter(j.fit.plant, pairs[1].fit.plant, stays.id).value();
  EXPECT_EQ(sim::plant::parameter_value(j.fit.plant, id), 0.01);
  EXPECT_NE(std::ranges::find(j.hypothesis.free, id, &fit::FreeParameter::id), j.hypothesis.free.end());
}
TEST_F(Crossing, FitsNothing_WhenAnEffectRequiresAnother) {
  const std::vector<Judgement> pairs = {beside(alone("TGOV1", 0.06), "TGOV1:db", 0.001),
                                        beside(alone("CTERROR", 0.01), "STEPUP", 0.07)};
  Judgement j = crossed(base_model_, {"STEPUP", &pairs[1], "TGOV1:db", &pairs[0], 0});
  try_begun(base_model_, j);
  EXPECT_FALSE(j.fit.failed.empty());
  EXPECT_EQ(full_name(j.hypothesis), "TGOV1:db + STEPUP");
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
