// Parameters from the staged tests of a MOD-026 report, and the comparison of the right model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/validate/calibrate/one_wrong_parameter.hpp"
#include "tests/validate/playin/staged_case.hpp"
#include "validate/calibrate/calibrate.hpp"

namespace swingbank::validate::calibrate {
namespace {

using Staged = record::StagedEvent::Kind;

void expect_recovered(const sim::plant::PlantUnderTest& c, const record::Record& r,
                      const std::string& parameter) {
  plant::PlantModel model;
  model.plant = c.plant;
  model.conventions = c.conventions;
  test::expect_found(std::move(model), {r}, parameter, 1.3);
}

TEST(CalibrateStagedTest, OpenCircuitStepGivesTheTransientTimeConstant) {
  const record::Record r = test::open_circuit_record(0.05, 2e-4, 0.005);
  const sim::plant::Plant plant = test::unloaded_plant();
  const sim::Conventions conventions = sim::Conventions::psse();
  for (const char* parameter : {"GENROU.Tdop", "SEXS.K"})
    expect_recovered({plant, conventions}, r, parameter);
}

TEST(CalibrateStagedTest, LoadRejectionGivesTheInertiaAndTheReactance) {
  const auto c = test::simulated_staged({"SEXS", "TGOV1"}, {.open = 2.0052, .end = 8, .rate = 60});
  const record::Record r = test::staged_record(c, {{Staged::load_rejection, 2.0}}, 0, 2e-4, 0.005);
  for (const char* parameter : {"GENROU.H", "GENROU.Xdp", "SEXS.K"})
    expect_recovered({c.plant(), c.grid.conventions}, r, parameter);
}

TEST(CalibrateStagedTest, ReferenceStepGivesTheExcitersGain) {
  const auto c =
      test::simulated_staged({"SEXS", "TGOV1"}, {.step = 2.0, .dVref = 0.03, .end = 8, .rate = 60});
  const record::Record r = test::staged_record(c, {{Staged::vref_step, 2.0, 1e5, 0.03}}, 0, 2e-4, 0.02);
  expect_recovered({c.plant(), c.grid.conventions}, r, "SEXS.K");
}

}  // namespace
}  // namespace swingbank::validate::calibrate
