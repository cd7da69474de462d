// The score test foretells what a fit would gain.
#include "validate/fit/rao_score.hpp"

#include <gtest/gtest.h>

#include "tests/validate/fit/exciter_example.hpp"

namespace swingbank::validate::fit {
namespace {

/// The exciter's time constant is too short.
struct Example : ExciterExample {
  Example() : ExciterExample(1.0, 0.0455) {}
  [[nodiscard]] Fit stage_of(const std::vector<std::string>& names) const {
    return fitted(names, {.enough = 1e-9});
  }
  /// Slopes of the fitted model's answer, per relative change.
  [[nodiscard]] std::vector<ScoreTest::Change> slopes(const ScoreTest& score, const Fit& stage,
                                                      const std::vector<std::string>& names) const {
    std::vector<playin::Direction> along;
    for (const auto& f : free(names))
      along.push_back({.kind = playin::Direction::Kind::parameter,
                       .parameter = f.id,
                       .scale = parameter_value(stage.plant, f.id)});
    return score.slopes({stage.plant, model.conventions}, along);
  }
};

TEST(ScoreTest, ForetellsWhatAFitGains) {
  const Example e;
  const Fit stage = e.stage_of({"H", "Xdp"}), with = e.stage_of({"H", "Xdp", "TE"});
  const ScoreTest score(e.events, e.model.under_test(), stage);
  const auto changes = e.slopes(score, stage, {"TE"});
  ASSERT_EQ(changes.size(), 1U);
  const double gained = penalised(stage) - penalised(with);
  EXPECT_GT(gained, 10);                                 // or there is nothing to foretell
  EXPECT_NEAR(changes[0].gain(), gained, 0.2 * gained);  // TE is off by 5 to 9 %, the answer bends over that
  EXPECT_LT(changes[0].square, changes[0].whole);        // H and Xdp can do a part of it
}
TEST(ScoreTest, WhatTheStructureCanDoItselfIsNoGain) {
  const Example e;
  const Fit stage = e.stage_of({"H", "Xdp"});
  const ScoreTest score(e.events, e.model.under_test(), stage);
  for (const auto& c : e.slopes(score, stage, {"H", "Xdp"})) EXPECT_LT(c.gain(), 0.1);  // of chi2, 1 by noise
}
TEST(ScoreTest, ChangesOfOneKindCountOnce) {
  const Example e;
  const Fit stage = e.stage_of({"H", "Xdp"});
  const ScoreTest score(e.events, e.model.under_test(), stage);
  const auto one = e.slopes(score, stage, {"TE"});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_NEAR(score.joint_gain({one[0], one[0]}), one[0].gain() - 1, 1e-6 * one[0].gain());
  EXPECT_DOUBLE_EQ(score.joint_gain({}), 0.0);
}
TEST(ScoreTest, APlantThatCannotBeRunGivesNothing) {
  const Example e;
  const Fit stage = e.stage_of({"H"});
  const ScoreTest score(e.events, e.model.under_test(), stage);
  sim::plant::Plant broken = stage.plant;
  broken.controls.front().p[3] = -1.0;  // a negative time constant
  EXPECT_FALSE(score.change_to({broken, e.model.conventions}));
  EXPECT_TRUE(score.slopes({broken, e.model.conventions}, {}).empty());
}

}  // namespace
}  // namespace swingbank::validate::fit
