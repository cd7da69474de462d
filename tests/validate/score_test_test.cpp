// The score test foretells what a fit would gain.
#include "validate/score_test.hpp"

#include <gtest/gtest.h>

#include "support.hpp"

namespace swingbank::validate {
namespace {

constexpr double kSpread = 1.0;

/// An example event and its plant; the exciter's time constant is too short.
struct Example {
  PlantModel model = load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  std::vector<FitEvent> events;
  Example() {
    model.plant.controls.push_back({sim::find_effect("SEXS"), {0.1, 10, 100, 0.0455, -4.0, 5.0}});
    Record r = read_record(test::source("configs/records/record-example/avr_ev1.csv"), model.record_base);
    events = prepare_events(model, {r}, {.measured_states = false});
  }
  [[nodiscard]] std::vector<FreeParameter> free(const std::vector<std::string>& names) const {
    std::vector<FreeParameter> some;
    for (const auto& f : free_parameters(model.plant, kSpread))
      if (std::ranges::count(names, parameter_record(model.plant, f.block, f.index).name) > 0)
        some.push_back(f);
    return some;
  }
  [[nodiscard]] Fit fitted(const std::vector<std::string>& names) const {
    return fit(model.plant, model.conventions, events, free(names), {.enough = 1e-9});
  }
  /// Slopes of the fitted model's answer, per relative change.
  [[nodiscard]] std::vector<ScoreTest::Change> slopes(const ScoreTest& score, const Fit& stage,
                                                      const std::vector<std::string>& names) const {
    std::vector<Direction> along;
    for (const auto& f : free(names))
      along.push_back(
          {Direction::Kind::parameter, f.block, f.index, parameter_value(stage.plant, f.block, f.index)});
    return score.slopes(stage.plant, model.conventions, along);
  }
};

TEST(ScoreTest, ForetellsWhatAFitGains) {
  const Example e;
  const Fit stage = e.fitted({"H", "Xdp"}), with = e.fitted({"H", "Xdp", "TE"});
  const ScoreTest score(e.events, e.model.plant, e.model.conventions, stage);
  const auto changes = e.slopes(score, stage, {"TE"});
  ASSERT_EQ(changes.size(), 1U);
  const double gained = penalised(stage) - penalised(with);
  EXPECT_GT(gained, 10);                                 // or there is nothing to foretell
  EXPECT_NEAR(changes[0].gain(), gained, 0.2 * gained);  // TE is off by 5 to 9 %, the answer bends over that
  EXPECT_LT(changes[0].square, changes[0].whole);        // H and Xdp can do a part of it
}
TEST(ScoreTest, WhatTheStructureCanDoItselfIsNoGain) {
  const Example e;
  const Fit stage = e.fitted({"H", "Xdp"});
  const ScoreTest score(e.events, e.model.plant, e.model.conventions, stage);
  for (const auto& c : e.slopes(score, stage, {"H", "Xdp"})) EXPECT_LT(c.gain(), 0.1);  // of chi2, 1 by noise
}
TEST(ScoreTest, ChangesOfOneKindCountOnce) {
  const Example e;
  const Fit stage = e.fitted({"H", "Xdp"});
  const ScoreTest score(e.events, e.model.plant, e.model.conventions, stage);
  const auto one = e.slopes(score, stage, {"TE"});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_NEAR(score.joint_gain({one[0], one[0]}), one[0].gain() - 1, 1e-6 * one[0].gain());
  EXPECT_DOUBLE_EQ(score.joint_gain({}), 0.0);
}
TEST(ScoreTest, APlantThatCannotBeRunGivesNothing) {
  const Example e;
  const Fit stage = e.fitted({"H"});
  const ScoreTest score(e.events, e.model.plant, e.model.conventions, stage);
  sim::Plant broken = stage.plant;
  broken.controls.front().p[3] = -1.0;  // a negative time constant
  EXPECT_FALSE(score.change_to(broken, e.model.conventions));
  EXPECT_TRUE(score.slopes(broken, e.model.conventions, {}).empty());
}

}  // namespace
}  // namespace swingbank::validate
