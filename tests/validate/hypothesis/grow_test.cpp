// Parts of an effect that its standard values leave off.
#include "validate/hypothesis/grow.hpp"

#include <gtest/gtest.h>

#include "tests/validate/fit/exciter_example.hpp"
#include "validate/hypothesis/judge.hpp"

namespace swingbank::validate::hypothesis {
namespace {

constexpr double kGrowSpread = 0.2;              ///< believed of the machine's parameters
constexpr double kFeedback = 0.05, kFast = 0.1;  ///< KF [pu], TF [s]

/// An event of a plant with EXST1 and this rate feedback; the hypothesis has none.
class Grow : public ::testing::Test {
 protected:
  void hide(double KF) {
    Hypothesis truth = exst1_;
    parameter(truth.plant, "KF") = KF;
    parameter(truth.plant, "TF") = kFast;  // fast, or a lead-lag does what the feedback does
    event::FitEvent e = events_.front();
    const playin::Response r = fit::answer(e, {}, truth.under_test());
    e.record.P = r.of(playin::Output::P);
    e.record.Q = r.of(playin::Output::Q);
    events_ = {{e}, events_.noise_model()};
    fit_ = fit::fit(exst1_.under_test(), events_, free_of(exst1_, kGrowSpread));
  }
  static double& parameter(sim::plant::Plant& plant, std::string_view name) {
    sim::plant::Block& exciter = plant.controls.back();
    const auto at = std::ranges::find(exciter.effect->parameters, name, &sim::Parameter::name);
    return exciter.p[static_cast<std::size_t>(at - exciter.effect->parameters.begin())];
  }
  [[nodiscard]] Hypothesis named(const std::string& name) const {
    const auto all = all_hypotheses(model_.under_test(), model_.library);
    return *std::ranges::find(all, name, &Hypothesis::name);
  }
  const plant::PlantModel model_ = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  event::WhitenedEvents events_ = event::prepare_events(
      model_,
      {record::read_record(test::source("configs/records/record-example/avr_ev1.csv"), model_.record_base)},
      {.measured_states = false});
  Hypothesis exst1_ = named("EXST1");
  fit::Fit fit_;
};

TEST_F(Grow, ARateFeedbackThatIsThereIsFreed) {
  hide(kFeedback);
  const double before = fit::criterion(fit_);
  const std::size_t parts = exst1_.free.size();
  grow(events_, kGrowSpread, exst1_, fit_);
  EXPECT_LT(fit::criterion(fit_), before - 100);
  ASSERT_GT(exst1_.free.size(), parts);
  EXPECT_EQ(exst1_.starts.front().size(), exst1_.free.size());
  for (const auto& [name, true_value] : {std::pair("KF", kFeedback), std::pair("TF", kFast)}) {
    const auto p = std::ranges::find(fit_.parameters, name, &fit::FittedParameter::name);
    ASSERT_NE(p, fit_.parameters.end()) << name;
    EXPECT_NEAR(p->value, true_value, 3 * p->error) << name;
  }
}
TEST_F(Grow, NothingIsFreedWithoutNeed) {
  hide(0.0);
  const std::size_t parts = exst1_.free.size();
  grow(events_, kGrowSpread, exst1_, fit_);
  EXPECT_EQ(exst1_.free.size(), parts);
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
