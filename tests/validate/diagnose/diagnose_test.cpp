// Diagnosis of the example records from P and Q alone; the model lacks the machine's exciter.
#include "validate/diagnose/diagnose.hpp"

#include <gmock/gmock.h>

#include <random>

#include "sim/library/library.hpp"
#include "sim/library/variants.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/playin/instruments.hpp"

namespace swingbank::validate::diagnose {
namespace {

std::vector<record::Record> example_records(const plant::PlantModel& model) {
  std::vector<record::Record> records;
  for (int i = 1; i <= 4; ++i)
    records.push_back(record::read_record(
        test::source("configs/records/record-example/avr_ev" + std::to_string(i) + ".csv"),
        model.record_base));
  return records;
}

TEST(Hypotheses, IncludeEveryFittingEffectAndNullGroup) {
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  std::vector<std::string> names;
  for (const auto& h : hypothesis::all_hypotheses(model.under_test(), model.library)) names.push_back(h.name);
  for (const sim::Effect& e : sim::library::compiled_effects()) {
    const bool instrument = e.slot == sim::Slot::measurement && playin::can_be_taken_back(e) &&
                            playin::changes_playback(e, false);
    const bool joins = (e.slot == sim::Slot::transformer || sim::is_control(e.slot) || instrument) &&
                       e.switching_times == nullptr && sim::library::variant_of(e) == nullptr;
    const bool suits = sim::slot_conflict(*model.plant.machine.effect, e).empty() && !sim::reader_of(e.slot);
    EXPECT_EQ(std::ranges::count(names, e.name), joins && suits ? 1 : 0) << e.name;
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"GENROU:D", "GENROU:S10,S12", "GENROU:Ra", "speed-voltage"}));
}
TEST(Hypotheses, LeaveOccupiedSlotsUnchanged) {
  plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const auto* sexs = sim::library::compiled().find("SEXS");
  model.plant.controls.push_back({sexs, sexs->default_parameters()});
  for (const auto& h : hypothesis::all_hypotheses(model.under_test(), model.library))
    EXPECT_NE(h.slot, static_cast<int>(sim::Slot::exciter)) << h.name;
}

TEST(DiagnoseFull, NamesMissingExciter) {
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  DiagnoseOptions options;
  options.events.measured_states = false;
  const Diagnosis d = diagnose(model, example_records(model), options);
  EXPECT_NE(d.verdict, Verdict::adequate);
  EXPECT_NE(d.verdict, Verdict::unexplained);
  EXPECT_EQ(d.side, hypothesis::Side::excitation);
  EXPECT_THAT(d.effects, testing::ElementsAre("SEXS"));
  // A freely estimated field voltage explains the residual, a freely estimated torque does not.
  EXPECT_LT(d.field.reduced_chi2(), 1.1);
  EXPECT_GT(d.torque.reduced_chi2(), 100);
  const hypothesis::Judgement& best = d.ranked.front();
  for (const auto& h : best.held_out) {
    EXPECT_GT(h.before, 100) << h.record;
    EXPECT_LT(h.after, 1.1) << h.record;  // 1 + 3 standard deviations of chi2 per value, plus a margin
  }
  // The truth (configs/records/README.md) within three standard errors. The README states K 93 +- 11, TE
  // 0.053 +- 0.004 s from three of these events.
  struct Known {
    std::string_view name;
    double value, most;  // `most`: largest permitted standard error
  };
  for (const Known& known : {Known{"TE", 0.05, 0.006}, Known{"K", 100, 16}, Known{"H", 6.54, 0.05}}) {
    const auto p = std::ranges::find(best.fit.parameters, known.name, &fit::FittedParameter::name);
    ASSERT_NE(p, best.fit.parameters.end()) << known.name;
    EXPECT_NEAR(p->value, known.value, 3 * p->error) << known.name;
    EXPECT_GT(p->error, 0) << known.name;
    EXPECT_LT(p->error, known.most) << known.name;
  }
}

/// The example's voltages and the simulated response with EXST1 of these values, with noise.
std::vector<record::Record> records_with_exst1(
    const plant::PlantModel& model, const std::vector<std::pair<std::string_view, double>>& values) {
  constexpr double kNoise = 0.002;  // of P and Q [pu]
  sim::plant::Plant truth = model.plant;
  const sim::Effect* exst1 = sim::library::compiled().find("EXST1");
  sim::plant::Block exciter{exst1, exst1->default_parameters()};
  for (const auto& [name, value] : values) {
    const auto at = std::ranges::find(exst1->parameters, name, &sim::Parameter::name);
    exciter.p[static_cast<std::size_t>(at - exst1->parameters.begin())] = value;
  }
  sim::plant::insert_block(truth, exciter);
  auto records = example_records(model);
  const noise::WhitenedEvents events = noise::whitened_events(model, records, {.measured_states = false});
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, kNoise);
  for (std::size_t e = 0; e < events.size(); ++e) {
    const playin::Response r = event::play({truth, model.conventions}, events[e], {});
    records[e].P = r.of(playin::Output::P);
    records[e].Q = r.of(playin::Output::Q);
    for (auto* channel : {&records[e].P, &records[e].Q})
      for (double& value : *channel) value += noise(random);
  }
  return records;
}
TEST(DiagnoseNightly, FindsExciterWithRateFeedback) {
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  DiagnoseOptions options;
  options.events.measured_states = false;
  const Diagnosis d = diagnose(
      model, records_with_exst1(model, {{"KA", 60}, {"KC", 0.3}, {"KF", 0.04}, {"TF", 0.15}, {"TB", 4}}),
      options);
  const auto found = std::ranges::find(d.ranked, "EXST1", [](const auto& j) { return j.hypothesis.name; });
  ASSERT_NE(found, d.ranked.end());
  EXPECT_TRUE(found->accepted) << found->why_not;
  EXPECT_LT(found->fit.reduced_chi2(), 1.05);
  const bool first = std::ranges::count(d.effects, "EXST1") > 0;
  const bool in_set = std::ranges::count(d.equivalent, "EXST1") > 0;
  EXPECT_TRUE(first || in_set) << d.sentence;
}

}  // namespace
}  // namespace swingbank::validate::diagnose
