// Parameters from the staged tests that a MOD-026 report holds, and what compare says of the right model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/validate/playin/staged_case.hpp"
#include "validate/calibrate/calibrate.hpp"

namespace swingbank::validate::calibrate {
namespace {

using Staged = record::StagedEvent::Kind;

/// One wrong parameter, everything else fixed: its fit.
CalibratedParameter recovered(const sim::plant::PlantUnderTest& c, record::Record r,
                              const std::string& parameter, double factor, double& truth) {
  plant::PlantModel model;
  model.plant = c.plant;
  model.conventions = c.conventions;
  model.record_base = r.base;
  Problems problems;
  std::vector<sim::plant::ParameterId> all;
  for (const auto& f : fit::free_parameters(model.plant, 0.3)) all.push_back(f.id);
  const auto wanted = sim::plant::find_parameters(model.plant, all, {parameter}, "test", "", problems);
  truth = sim::plant::parameter_value(model.plant, wanted.front());
  sim::plant::parameter_value(model.plant, wanted.front()) *= factor;
  CalibrateOptions options;
  options.draws = options.starts = 0;
  for (const auto& id : all)
    if (id != wanted.front()) options.fixed.push_back(sim::plant::parameter_name(model.plant, id).text());
  const Calibration found = calibrate(model, {std::move(r)}, options);
  EXPECT_EQ(found.adequacy, Adequacy::parameters_poor) << parameter << ": " << found.sentence;
  return found.parameters.front();
}

void expect_recovered(const sim::plant::PlantUnderTest& c, const record::Record& r,
                      const std::string& parameter) {
  double truth = 0;
  const CalibratedParameter p = recovered(c, r, parameter, 1.3, truth);
  EXPECT_NEAR(p.fit.value, truth, 4 * p.fit.error) << parameter;
  EXPECT_LT(p.fit.error, 0.1 * truth) << parameter;
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
