// Controls identified alone, then fitted with the whole plant.
#include "validate/hypothesis/identified.hpp"

#include <gtest/gtest.h>

#include "tests/validate/playin/support.hpp"
#include "validate/event/event.hpp"
#include "validate/hypothesis/search.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// The README's example: four faults at a plant whose model has no exciter.
class IdentifiedExciter : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<Judgement> found(const std::vector<std::string>& names) const {
    return found(base_model_, names);
  }
  [[nodiscard]] std::vector<Judgement> found(const BaseModel& base_model,
                                             const std::vector<std::string>& names) const {
    auto all = all_hypotheses(model_.under_test(), model_.library);
    std::erase_if(all, [&](const Hypothesis& h) { return std::ranges::count(names, h.name) == 0; });
    return identified(base_model, std::move(all), [](double least) { return least; }, {});
  }
  static std::vector<record::Record> records(const plant::PlantModel& model) {
    std::vector<record::Record> all;
    for (int k = 1; k <= 4; ++k)
      all.push_back(record::read_record(
          test::source("configs/records/record-example/avr_ev" + std::to_string(k) + ".csv"),
          model.record_base));
    return all;
  }
  const plant::PlantModel model_ = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const noise::WhitenedEvents events_ =
      noise::whitened_events(model_, records(model_), {.measured_states = false});
  const fit::Fit base_ = fit::fit(model_.under_test(), events_, {}, {.iterations = 0});
  const BaseModel base_model_{.events = events_,
                              .plant = model_.plant,
                              .conventions = model_.conventions,
                              .library = model_.library,
                              .fit = base_};
};

TEST_F(IdentifiedExciter, ReachesTheOptimumFoundFromTheTruth) {
  const auto all = found({"SEXS", "ESST4B"});
  ASSERT_EQ(all.size(), 2U);
  const Judgement& best = all.front();
  EXPECT_EQ(best.hypothesis.name, "SEXS");
  ASSERT_TRUE(best.fitted);
  EXPECT_LT(best.fit.reduced_chi2(), 1.05);
  // Fit at the parameter values of the plant that made the records.
  const auto free = free_of(best.hypothesis, base_model_.prior_sd);
  fit::FitOptions truth{.iterations = 20, .lenient = true};
  truth.start = states_of(best.fit.events);
  truth.values = fit::values_of(best.hypothesis.plant, free);
  const fit::Fit there = fit::fit({best.hypothesis.plant, best.hypothesis.conventions}, events_, free, truth);
  EXPECT_LT(fit::penalised(best.fit), fit::penalised(there) + 5);
  // A hypothesis whose preliminary fit is far worse than the best is not fitted, and it states so.
  EXPECT_FALSE(all.back().fitted);
  EXPECT_GT(all.back().behind, 1000);
  EXPECT_NE(all.back().why_not.find("than that of SEXS"), std::string::npos) << all.back().why_not;
}

/// A phase error of an instrument transformer is found in addition to the exciter; without a phase error none
/// is found. Phase errors of voltage and current rotate the power in the same way.
TEST_F(IdentifiedExciter, FindsTheMissingCompanionToo) {
  EXPECT_EQ(found({"SEXS"}).front().companion, "");
  auto wrong = records(model_);
  for (record::Record& r : wrong)
    for (std::size_t k = 0; k < r.t.size(); ++k) {
      const Complex S = std::polar(1.0, 0.05) * Complex(r.P[k], r.Q[k]);
      r.P[k] = S.real();
      r.Q[k] = S.imag();
    }
  const auto events = noise::whitened_events(model_, wrong, {.measured_states = false});
  const fit::Fit base = fit::fit(model_.under_test(), events, {}, {.iterations = 0});
  const BaseModel base_model{.events = events,
                             .plant = model_.plant,
                             .conventions = model_.conventions,
                             .library = model_.library,
                             .fit = base};
  for (const Judgement& j : found(base_model, {"SEXS", "EXST1"})) {
    EXPECT_TRUE(j.companion == "CTERROR" || j.companion == "PTERROR")
        << j.hypothesis.name << ": " << j.companion;
    EXPECT_GT(j.companion_gain, thresholds::evidence.second) << j.hypothesis.name;
  }
}

TEST_F(IdentifiedExciter, IsNotFitted_WhenTheBaseModelReachesTheNoise) {
  const Judgement first = found({"SEXS"}).front();
  const BaseModel then = after(base_model_, first);
  auto all = all_hypotheses(then.under_test(), then.library);
  std::erase_if(all, [&](const Hypothesis& h) { return h.name != "IEEEVC" && h.name != "TGOV1"; });
  ASSERT_EQ(all.size(), 2U);
  for (const Judgement& j : identified(then, all, [](double least) { return least; }, {})) {
    EXPECT_FALSE(j.fitted) << j.hypothesis.name;
    EXPECT_LT(j.gain, thresholds::evidence.second / 2) << j.hypothesis.name;
    if (j.hypothesis.name == "TGOV1") {
      EXPECT_EQ(j.why_not, "not fitted: even an arbitrary torque reduces the residual too little");
    }
  }
}

TEST_F(IdentifiedExciter, IsNotFitted_IfItCannotBeAccepted) {
  BaseModel base_model = base_model_;
  base_model.required = 100;
  EXPECT_FALSE(cannot_be_accepted(base_model, 105, 200));  // the gain of 95 may be wrong by a tenth
  EXPECT_TRUE(cannot_be_accepted(base_model, 112, 200));
  base_model.required = -fit::penalised(base_);  // out of reach even with an error of a tenth
  const auto none = found(base_model, {"SEXS"});
  ASSERT_EQ(none.size(), 1U);
  EXPECT_FALSE(none.front().fitted);
  EXPECT_NE(none.front().why_not.find("too small"), std::string::npos) << none.front().why_not;
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
