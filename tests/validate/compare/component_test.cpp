// Comparison of components: with the right model the residual is only noise; with a wrong parameter or a
// missing block it is larger.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/validate/playin/component_case.hpp"
#include "validate/compare/compare.hpp"
#include "validate/event/component_model.hpp"

namespace swingbank::validate::compare {
namespace {

using record::Component;
using ::testing::HasSubstr;

/// The component of a simulated machine and its noisy record. Switching times lie between the samples.
struct Tried {
  test::ComponentCase simulated;
  plant::PlantModel model;
  record::Record record;
  Tried(const std::vector<std::string>& controls, Component component)
      : simulated(test::simulated_component(controls, {.on = 2.0062, .off = 2.1131, .end = 10, .rate = 60})),
        record(test::component_record(simulated, component,
                                      {.V = 1e-4,
                                       .P = 1e-4,
                                       .speed = 1e-6,
                                       .Efd = component == Component::machine ? 0.002 : 0.02,
                                       .Pm = 1e-4})) {
    model.name = "tried";
    model.plant = simulated.plant();
    model.conventions = simulated.grid.conventions;
    model.record_base = record.base;
    model = event::component_model(std::move(model), component);
  }
  [[nodiscard]] Adequacy adequacy(std::vector<std::string>* channels = nullptr) const {
    std::vector<EventComparison> events = {compare_event(model, record)};
    if (channels)
      for (const auto& c : events.front().channels) channels->push_back(c.name);
    return judge(events);
  }
};

TEST(CompareComponentTest, JudgesRightExciterAndWrongGain) {
  Tried t({"IEEET1", "STAB1"}, Component::exciter);
  std::vector<std::string> channels;
  const Adequacy right = t.adequacy(&channels);
  EXPECT_THAT(channels, ::testing::ElementsAre("Efd"));
  EXPECT_TRUE(right.adequate) << right.sentence;
  auto& exciter = t.model.plant.controls.back();
  exciter.p[static_cast<std::size_t>(exciter.effect->parameter_index("KA"))] *= 1.5;
  const Adequacy wrong = t.adequacy();
  EXPECT_FALSE(wrong.adequate) << wrong.sentence;
}

TEST(CompareComponentTest, ExciterWithoutItsStabiliserIsInadequate) {
  Tried t({"IEEET1", "STAB1"}, Component::exciter);
  std::erase_if(t.model.plant.controls,
                [](const auto& b) { return b.effect->slot == sim::Slot::stabiliser; });
  EXPECT_FALSE(t.adequacy().adequate);
}

TEST(CompareComponentTest, JudgesRightGovernorAndWrongDroop) {
  Tried t({"TGOV1"}, Component::governor);
  std::vector<std::string> channels;
  const Adequacy right = t.adequacy(&channels);
  EXPECT_THAT(channels, ::testing::ElementsAre("Pm"));
  EXPECT_TRUE(right.adequate) << right.sentence;
  t.model.plant.controls.front().p[0] *= 1.3;
  EXPECT_FALSE(t.adequacy().adequate);
}

TEST(CompareComponentTest, NotesThatFrequencyReplacesSpeed) {
  Tried t({"TGOV1"}, Component::governor);
  const auto notes = [&] { return compare_event(t.model, t.record).notes; };
  EXPECT_THAT(notes(), ::testing::Not(::testing::Contains(HasSubstr("has no speed"))));
  std::swap(t.record.f, t.record.speed);
  EXPECT_THAT(notes(), ::testing::Contains(HasSubstr("has no speed")));
}

TEST(CompareComponentTest, JudgesRightMachineAndWrongReactance) {
  Tried t({"SEXS", "TGOV1"}, Component::machine);
  std::vector<std::string> channels;
  const Adequacy right = t.adequacy(&channels);
  EXPECT_THAT(channels, ::testing::ElementsAre("P", "Q", "speed", "Ifd"));
  EXPECT_TRUE(right.adequate) << right.sentence;
  auto& machine = t.model.plant.machine;
  machine.p[static_cast<std::size_t>(machine.effect->parameter_index("Xdp"))] *= 1.3;
  EXPECT_FALSE(t.adequacy().adequate);
}

/// Output of an excitation system's recorder at 208/s: no angle, quantities in their own units, Efd with
/// noise and the ripple of six thyristors (300 Hz, aliased to 92 Hz).
std::string excitation_recorder(const test::ComponentCase& c) {
  std::string text = "Time [s],Ug [kV],Ig [kA],P [MW],Q [Mvar],Ifd [A],Efd [V]\n";
  const record::Record r = test::component_record(c, Component::exciter, {.V = 1e-4, .P = 1e-3, .Efd = 0.03});
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const double ripple = 0.1 * std::sin(2 * std::numbers::pi * 300 * r.t[k] + 0.3);
    text += fmt::format("{:.6f},{:.5f},{:.5f},{:.4f},{:.4f},{:.3f},{:.4f}\n", r.t[k], 13.8 * r.V[k],
                        std::hypot(r.P[k], r.Q[k]) / r.V[k] * 100 / 13.8 / std::numbers::sqrt3, 100 * r.P[k],
                        100 * r.Q[k], 850 * r.Ifd[k], 92 * (r.Efd[k] + ripple));
  }
  return text;
}

TEST(CompareComponentTest, ReadsExcitationRecorderAt208HzWithoutAngle) {
  const auto simulated = test::simulated_component(std::vector<std::string>{"ESAC1A"},
                                                   {.on = 2.0062, .off = 2.1131, .end = 10, .rate = 208});
  plant::PlantModel model;
  model.plant = simulated.plant();
  model.conventions = simulated.grid.conventions;
  model.record_base = {.mva = 100, .kv = 13.8, .efd = 92};
  model = event::component_model(std::move(model), Component::exciter);
  const std::string text = excitation_recorder(simulated);
  EXPECT_THAT(test::messages([&] { record::parse_record(text, "x.csv", model.record_base, model.reading); }),
              ::testing::ElementsAre(HasSubstr("ifd_base")));  // ESAC1A uses Ifd
  model.record_base.ifd = 850;
  const record::Record r = record::parse_record(text, "x.csv", model.record_base, model.reading);
  EXPECT_NEAR(r.rate(), 208, 1e-3);
  std::vector<EventComparison> right = {compare_event(model, r)};
  const Adequacy adequate = judge(right);
  EXPECT_TRUE(adequate.adequate) << adequate.sentence;
  auto& exciter = model.plant.controls.back();
  exciter.p[static_cast<std::size_t>(exciter.effect->parameter_index("KF"))] *= 1.5;
  std::vector<EventComparison> wrong = {compare_event(model, r)};
  EXPECT_FALSE(judge(wrong).adequate);
  // The record of the whole plant lacks the angle, so P and Q are played in.
  const record::Record whole = record::parse_record(text, "x.csv", model.record_base, {});
  EXPECT_EQ(whole.angle, record::AngleSource::none);
  EXPECT_THAT(whole.notes, ::testing::Contains(HasSubstr("neither angle nor frequency")));
  EXPECT_THAT(whole.notes, ::testing::Contains(HasSubstr("--component exciter")));
}

TEST(CompareComponentTest, ReportsAndRestoresOmittedBlocks) {
  plant::PlantModel model;
  model.plant.machine = test::default_block("GENROU");
  for (const auto* name : {"TGOV1", "SEXS"}) sim::plant::insert_block(model.plant, test::default_block(name));
  const plant::PlantModel part = event::component_model(model, Component::governor);
  ASSERT_EQ(part.warnings.size(), 1u);
  EXPECT_THAT(part.warnings.front(), HasSubstr("governor is tested alone: GENROU, SEXS"));
  EXPECT_EQ(part.plant.controls.size(), 1u);
  const plant::PlantModel whole = event::whole_model(part);
  EXPECT_EQ(whole.plant.machine.effect->name, "GENROU");
  EXPECT_EQ(whole.plant.controls.size(), 2u);
}

}  // namespace
}  // namespace swingbank::validate::compare
