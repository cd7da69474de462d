// Other optima of an effect.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/validate/fit/exciter_example.hpp"
#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// An event of a plant with EXAC1 far from its standard values; the model has no exciter.
class Basins : public ::testing::Test {
 protected:
  Basins() {
    hypothesis_ = named("EXAC1");
    sim::plant::Plant truth = hypothesis_.plant;
    set(truth, kTruth);
    event::FitEvent e = events_.front();
    const playin::Response r = fit::answer(e, {}, {truth, model_.conventions});
    e.record.P = r.of(playin::Output::P);
    e.record.Q = r.of(playin::Output::Q);
    events_ = {{e}, events_.noise_model()};
  }
  using Values = std::vector<std::pair<std::string_view, double>>;
  const Values kTruth = {{"KA", 4.7}, {"TE", 0.3}, {"KF", 0.1}, {"TF", 0.3}, {"KC", 0.5}, {"KD", 0.1}};
  [[nodiscard]] int index(std::string_view name) const {
    const auto& known = hypothesis_.plant.controls.back().effect->parameters;
    return static_cast<int>(std::ranges::find(known, name, &sim::Parameter::name) - known.begin());
  }
  void set(sim::plant::Plant& plant, const Values& values) const {
    for (const auto& [name, value] : values)
      plant.controls.back().p[static_cast<std::size_t>(index(name))] = value;
  }
  [[nodiscard]] Hypothesis named(const std::string& name) const {
    const auto all = all_hypotheses(model_.under_test(), model_.library);
    return *std::ranges::find(all, name, &Hypothesis::name);
  }
  /// Where a fit ends that begins with these values.
  [[nodiscard]] fit::Fit fitted_from(const Values& values) const {
    const auto free = free_of(hypothesis_, stage_.spread);
    sim::plant::Plant start = hypothesis_.plant;
    set(start, values);
    fit::FitOptions o{.iterations = 30, .lenient = true};
    o.values = fit::values_of(start, free);
    return fit::fit(hypothesis_.under_test(), events_, free, o);
  }
  const plant::PlantModel model_ = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  event::WhitenedEvents events_ = event::prepare_events(
      model_,
      {record::read_record(test::source("configs/records/record-example/avr_ev1.csv"), model_.record_base)},
      {.measured_states = false});
  const fit::Fit base_ = fit::fit(model_.under_test(), events_, {}, {.iterations = 0});
  Hypothesis hypothesis_;
  const Stage stage_{.events = events_,
                     .plant = model_.plant,
                     .conventions = model_.conventions,
                     .library = model_.library,
                     .fit = base_};
};

TEST_F(Basins, AFitThatEndedAtALesserOptimumGetsOut) {
  const double least = fit::penalised(fitted_from(kTruth));
  for (const double TF : {1.0, 4.0}) {  // with the standard gain, a hundred times the true one
    Judgement j;
    j.hypothesis = hypothesis_;
    j.fit = fitted_from({{"TF", TF}});
    ASSERT_GT(fit::penalised(j.fit), 2 * least) << "it was meant to end elsewhere";
    try_basins(stage_, j);
    EXPECT_LT(fit::penalised(j.fit), 1.2 * least) << TF;
    EXPECT_FALSE(std::isnan(fit::criterion(j.fit))) << "its evidence needs errors";
  }
}
TEST_F(Basins, AFitAtItsOptimumStays) {
  Judgement j;
  j.hypothesis = hypothesis_;
  j.fit = fitted_from(kTruth);
  const double before = fit::criterion(j.fit);
  try_basins(stage_, j);
  EXPECT_LE(fit::criterion(j.fit), before);
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
