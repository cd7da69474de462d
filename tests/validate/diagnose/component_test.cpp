// The diagnosis names the missing stabiliser from records of the exciter alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/validate/playin/component_case.hpp"
#include "validate/diagnose/diagnose.hpp"
#include "validate/event/component_model.hpp"

namespace swingbank::validate::diagnose {
namespace {

using ::testing::Contains;

TEST(ComponentHypotheses, ContainOnlyBlocksOfTheComponent) {
  plant::PlantModel model;
  model.plant.machine = test::default_block("GENROU");
  model.conventions = sim::Conventions::psse();
  for (const auto component :
       {record::Component::exciter, record::Component::governor, record::Component::machine}) {
    const plant::PlantModel part = event::component_model(model, component);
    std::vector<std::string> names;
    for (const auto& h : hypothesis::all_hypotheses(part.under_test(), part.library, {component}))
      names.push_back(h.name);
    const bool exciter = component == record::Component::exciter,
               governor = component == record::Component::governor;
    EXPECT_EQ(std::ranges::count(names, "STAB1"), 0);  // no exciter reads its output
    EXPECT_EQ(std::ranges::count(names, "SEXS"), exciter ? 1 : 0);
    EXPECT_EQ(std::ranges::count(names, "TGOV1"), governor ? 1 : 0);
    EXPECT_EQ(std::ranges::count(names, "GENROU:Ra"), exciter || governor ? 0 : 1);
    EXPECT_EQ(std::ranges::count(names, "speed-voltage"), exciter || governor ? 0 : 1);
  }
}

TEST(DiagnoseComponentFull, NamesMissingStabiliser) {
  std::vector<record::Record> records;
  plant::PlantModel model;
  unsigned seed = 1;
  for (const auto& event :
       {test::ComponentEvent{4, 1.0031, 1.104, 10, 60}, test::ComponentEvent{5, 1.0071, 1.09, 10, 60},
        test::ComponentEvent{9, 1.011, 1.151, 10, 60}}) {
    const auto simulated = test::simulated_component(std::vector<std::string>{"IEEET1", "STAB1"}, event);
    records.push_back(test::component_record(simulated, record::Component::exciter,
                                             {.V = 1e-4, .P = 1e-3, .speed = 2e-6, .Efd = 0.02}, seed++));
    model.plant = simulated.plant();
    model.conventions = simulated.grid.conventions;
  }
  std::erase_if(model.plant.controls, [](const auto& b) { return b.effect->slot == sim::Slot::stabiliser; });
  model.record_base = records.front().base;
  model = event::component_model(std::move(model), record::Component::exciter);
  const Diagnosis d = diagnose(model, std::move(records));
  EXPECT_NE(d.verdict, Verdict::adequate) << d.sentence;
  auto named = d.effects;
  named.insert(named.end(), d.equivalent.begin(), d.equivalent.end());
  EXPECT_THAT(named, Contains("STAB1")) << d.sentence;
  EXPECT_EQ(d.side, hypothesis::Side::excitation);
}

}  // namespace
}  // namespace swingbank::validate::diagnose
