// Session of the live page: preview and comparison agree, steps, and messages of fits.
#include "validate/live/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/stop_signal.hpp"
#include "validate/check/record_set.hpp"
#include "validate/live/fits.hpp"
#include "validate/live/overview.hpp"

namespace swingbank::validate::live {
namespace {

using testing::HasSubstr;

/// The README's example with its last event.
std::shared_ptr<const Setup> example() {
  static const std::shared_ptr<const Setup> made = [] {
    const std::string source = SWINGBANK_SOURCE;
    auto s = std::make_shared<Setup>();
    s->model = plant::load_plant_model(source + "/configs/plants/ieee14_bus2.toml");
    auto set = check::read_records({source + "/configs/records/record-example/avr_ev4.csv"}, s->model);
    s->records = compare::power_only(std::move(set.records));
    s->measured = compare::measurements(s->records, s->compare, s->model.plant.mva);
    s->warnings = std::move(set.warnings);
    s->by = thresholds::read_acceptance("");
    s->prior_sd = 0.3;
    s->options = " --records avr_ev4.csv";
    s->plant_file = "plant.toml";
    return s;
  }();
  return made;
}
std::shared_ptr<const Step> submitted() {
  static const auto made = std::make_shared<const Step>(submitted_step(*example()));
  return made;
}

TEST(LiveSession, PreviewOfUnchangedModelEqualsItsComparison) {
  const Preview shown = preview(*submitted(), 0, {});
  const auto& event = submitted()->played->events[0];
  ASSERT_EQ(shown.channels.size(), event.channels.size());
  for (std::size_t k = 0; k < shown.channels.size(); ++k) {
    EXPECT_NEAR(shown.channels[k].whole.rms, event.channels[k].whole.rms, 1e-4 * event.channels[k].whole.rms);
    EXPECT_NEAR(shown.channels[k].noise, event.channels[k].noise, 1e-3 * event.channels[k].noise);
  }
}

TEST(LiveSession, PreviewFollowsTheParameterAsTheComparisonDoes) {
  Session session(example(), submitted());
  const int k = session.change(0, {{"GENROU.H", 4.0}});
  const auto after = session.step(k);
  const Preview shown = preview(*submitted(), 0, {{"GENROU.H", 4.0}});
  const double before = submitted()->played->events[0].channels[0].whole.rms,
               compared = after->played->events[0].channels[0].whole.rms;
  EXPECT_GT(std::abs(compared - before), 0.1 * before);
  // the comparison fits the switching times to the changed model, the preview keeps them
  EXPECT_NEAR(shown.channels[0].whole.rms, compared, 0.1 * compared);
}

TEST(LiveSession, ChangeIsAStepAndTheSubmittedModelStays) {
  Session session(example(), submitted());
  EXPECT_EQ(session.change(0, {{"GENROU.H", 6.54}}), 0);  // nothing changes
  const int k = session.change(0, {{"GENROU.H", 4.0}});
  EXPECT_EQ(session.steps(), 2);
  EXPECT_EQ(session.step(k)->parent, 0);
  EXPECT_THAT(session.step(k)->label, HasSubstr("GENROU.H 6.54 → 4 s"));
  EXPECT_EQ(parameter_value(session.step(0)->model.plant, find_parameter(example()->model.plant, "GENROU.H")),
            6.54);
}

TEST(LiveSession, RefusesWhatTheModelDoesNotHave) {
  Session session(example(), submitted());
  EXPECT_THROW(session.change(0, {{"GENROU.none", 1.0}}), InputError);
  EXPECT_THROW(session.change(0, {{"GENROU.H", std::numeric_limits<double>::quiet_NaN()}}), InputError);
  EXPECT_THROW(session.change(7, {{"GENROU.H", 4.0}}), InputError);
  EXPECT_THROW(preview(*submitted(), 1, {}), InputError);
  EXPECT_THROW((void)session.step(-1), InputError);
  EXPECT_EQ(session.steps(), 1);
}

TEST(LiveSession, DropsTheOldestManualStepsButNoParent) {
  Session session(example(), submitted(), 5);
  const int first = session.change(0, {{"GENROU.H", 4.0}});
  Step fitted;
  fitted.kind = Step::Kind::added;
  fitted.parent = first;
  fitted.model = example()->model;
  const int added = session.append(fitted);
  const int second = session.change(0, {{"GENROU.H", 4.1}});
  for (int k = 0; k < 4; ++k) session.change(0, {{"GENROU.H", 5.0 + 0.01 * k}});
  EXPECT_NO_THROW((void)session.step(0));
  EXPECT_NO_THROW((void)session.step(first));
  EXPECT_NO_THROW((void)session.step(added));
  EXPECT_THROW((void)session.step(second), InputError);
  EXPECT_NO_THROW((void)session.step(session.steps() - 1));
}

TEST(LiveFits, PlantSurvivesItsMessageBitByBit) {
  plant::PlantModel model = with_values(example()->model, {{"GENROU.H", 0.1 + 0.2}, {"GENROU.Xd", 1.0 / 3}});
  const auto text = plant_json(model).dump();
  const plant::PlantModel back = with_plant(example()->model, nlohmann::json::parse(text));
  EXPECT_EQ(back.plant.machine.p, model.plant.machine.p);
  EXPECT_EQ(back.plant.machine.effect, model.plant.machine.effect);
}

TEST(LiveFits, StepOfAnAdditionNamesTheCommand) {
  const nlohmann::json message = {{"kind", "added"},
                                  {"effect", "SEXS"},
                                  {"label", "+ SEXS"},
                                  {"sentence", ""},
                                  {"evidence", 12.0},
                                  {"held_out", {"avr_ev4.csv"}},
                                  {"parameters", {{{"name", "SEXS.K"}, {"low", 1.0}, {"high", 2.0}}}},
                                  {"bands", {{{"Q", {0.01, 0.02}}}}},
                                  {"plant", plant_json(example()->model)}};
  const Step s = step_of_fit(*example(), *submitted(), 0, message);
  EXPECT_EQ(s.command, "swingbank add SEXS --model plant.toml --records avr_ev4.csv --hold-out avr_ev4.csv");
  ASSERT_EQ(s.intervals.size(), 1U);
  EXPECT_EQ(s.intervals[0].high, 2.0);
  ASSERT_EQ(s.bands.size(), 1U);
  EXPECT_EQ(s.bands[0].at("Q"), (std::vector<double>{0.01, 0.02}));
}

/// The values of a fit that a user stops are a step without intervals. A manual change after a fit has none
/// either, because those of the fit do not hold for other values.
TEST(LiveFits, StoppedFitIsAStepWithoutIntervals) {
  nlohmann::json last;
  swingbank::detail::interruptible = 1;
  int messages = 0;
  run_fit(*example(), {{"kind", "calibrate"}, {"plant", plant_json(example()->model)}},
          [&](const nlohmann::json& m) {
            last = m;
            if (++messages == 3) ask_to_stop();
          });
  swingbank::detail::interruptible = 0;
  swingbank::detail::stop_asked = 0;
  ASSERT_EQ(last.at("type"), "step") << last.dump();
  Session session(example(), submitted());
  const int stopped = session.append(step_of_fit(*example(), *submitted(), 0, last));
  EXPECT_TRUE(session.step(stopped)->fitted);
  EXPECT_TRUE(session.step(stopped)->intervals.empty());
  EXPECT_TRUE(session.step(stopped)->command.empty());
  EXPECT_THAT(session.step(stopped)->sentence, HasSubstr("Stopped"));
  EXPECT_NE(session.step(stopped)->model.plant.machine.p, example()->model.plant.machine.p);

  Step fitted = *session.step(stopped);
  fitted.intervals = {{"GENROU.H", 4.0, 5.0}};
  const int changed = session.change(session.append(fitted), {{"GENROU.H", 6.0}});
  EXPECT_TRUE(session.step(changed)->intervals.empty());
  EXPECT_TRUE(session.step(changed)->fitted);
}

TEST(LiveFits, FailureIsAMessage) {
  std::vector<std::string> types;
  run_fit(*example(), {{"kind", "add"}, {"effect", "NOTHING"}, {"plant", plant_json(example()->model)}},
          [&](const nlohmann::json& m) { types.push_back(m.at("type")); });
  ASSERT_FALSE(types.empty());
  EXPECT_EQ(types.back(), "failed");
}

TEST(LiveOverview, ContainsEveryChannelAndParameter) {
  const auto json = step_json(*example(), *submitted(), 0);
  EXPECT_EQ(json.at("chips").size(), 2U);
  EXPECT_EQ(json.at("sliders").size(), submitted()->model.plant.machine.p.size());
  EXPECT_FALSE(json.at("complete"));
  const auto& event = submitted()->played->events[0];
  EXPECT_EQ(curves(*submitted(), 0).size(), event.record.t.size() * (1 + 3 * event.channels.size()));
  EXPECT_EQ(ribbon(*submitted(), 0, {}, "GENROU.Xd").size(),
            event.record.t.size() * 2 * event.channels.size());
}

TEST(LiveOverview, CurvesContainTheBandOfAFittedChannel) {
  Step fitted = *submitted();
  const auto& event = fitted.played->events[0];
  const std::size_t n = event.record.t.size();
  fitted.bands = {{{"Q", std::vector<double>(n, 0.01)}}};
  const auto samples = curves(fitted, 0);
  ASSERT_EQ(event.channels[0].name, "P");
  EXPECT_TRUE(std::isnan(samples[3 * n]));
  ASSERT_EQ(event.channels[1].name, "Q");
  EXPECT_FLOAT_EQ(samples[6 * n], static_cast<float>(0.01 * event.channels[1].scale));
  EXPECT_TRUE(step_json(*example(), fitted, 1).at("bands"));
  EXPECT_FALSE(step_json(*example(), *submitted(), 0).at("bands"));
}

}  // namespace
}  // namespace swingbank::validate::live
