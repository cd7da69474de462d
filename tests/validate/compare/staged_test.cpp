// Comparison of staged tests: with the right model the residual is only noise; with a wrong model or an
// undeclared test it is larger.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/validate/playin/staged_case.hpp"
#include "validate/compare/compare.hpp"

namespace swingbank::validate::compare {
namespace {

using Staged = record::StagedEvent::Kind;

Adequacy adequacy(const sim::plant::PlantUnderTest& tested, const record::Record& r) {
  plant::PlantModel model;
  model.plant = tested.plant;
  model.conventions = tested.conventions;
  model.record_base = r.base;
  std::vector<EventComparison> events = {compare_event(model, r)};
  return judge(events);
}

void expect_right_and_wrong(const sim::plant::PlantUnderTest& tested, const record::Record& r) {
  const Adequacy right = adequacy(tested, r);
  EXPECT_TRUE(right.adequate) << right.sentence;
  sim::plant::Plant wrong = tested.plant;
  sim::plant::Block& exciter = wrong.controls.back();
  exciter.p[static_cast<std::size_t>(exciter.effect->parameter_index("K"))] *= 1.5;
  EXPECT_FALSE(adequacy({wrong, tested.conventions}, r).adequate);
}

TEST(CompareStagedTest, LoadRejection) {
  const auto c = test::simulated_staged({"SEXS", "TGOV1"}, {.open = 2.0052, .end = 8, .rate = 60});
  expect_right_and_wrong({c.plant(), c.grid.conventions},
                         test::staged_record(c, {{Staged::load_rejection, 2.0}}, 0, 2e-4, 0.005));
}

TEST(CompareStagedTest, StepInOpenCircuit) {
  const sim::plant::Plant plant = test::unloaded_plant();
  const sim::Conventions conventions = sim::Conventions::psse();
  expect_right_and_wrong({plant, conventions}, test::open_circuit_record(0.05, 2e-4, 0.005));
}

TEST(CompareStagedTest, StepOfAReference) {
  const auto c =
      test::simulated_staged({"SEXS", "TGOV1"}, {.step = 2.0, .dVref = 0.03, .end = 8, .rate = 60});
  record::Record r = test::staged_record(c, {{Staged::vref_step, 2.0, 1e5, 0.03}}, 0, 2e-4, 0.01);
  expect_right_and_wrong({c.plant(), c.grid.conventions}, r);
  r.staged.clear();
  EXPECT_FALSE(adequacy({c.plant(), c.grid.conventions}, r).adequate);
}

}  // namespace
}  // namespace swingbank::validate::compare
