// A wrong parameter of an exciter, a governor or a machine alone is found from the component's records.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/validate/playin/component_case.hpp"
#include "validate/calibrate/calibrate.hpp"
#include "validate/event/component_model.hpp"

namespace swingbank::validate::calibrate {
namespace {

using record::Component;

/// Two noisy events of a component; its parameter stands `factor` times too high in the model. Only it is
/// free.
CalibratedParameter found(const std::vector<std::string>& controls, Component component,
                          const std::string& parameter, double factor, double& truth) {
  std::vector<record::Record> records;
  plant::PlantModel model;
  unsigned seed = 1;
  for (const auto& event :
       {test::ComponentEvent{4, 1.5062, 1.6131, 8, 60}, test::ComponentEvent{9, 1.5021, 1.6542, 8, 60}}) {
    const auto simulated = test::simulated_component(controls, event);
    records.push_back(test::component_record(simulated, component,
                                             {.V = 1e-4,
                                              .P = 5e-4,
                                              .speed = 1e-6,
                                              .Efd = component == Component::machine ? 0.002 : 0.02,
                                              .Pm = 2e-4},
                                             seed++));
    model.plant = simulated.plant();
    model.conventions = simulated.grid.conventions;
  }
  model.record_base = records.front().base;
  model = event::component_model(std::move(model), component);
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
  const Calibration c = calibrate(model, std::move(records), options);
  EXPECT_EQ(c.adequacy, Adequacy::parameters_poor) << parameter << ": " << c.sentence;
  return c.parameters.front();
}

TEST(CalibrateComponentTest, WrongParametersAreFoundWithinTheirIntervals) {
  const struct {
    std::vector<std::string> controls;
    Component component;
    std::string parameter;
  } cases[] = {{{"IEEET1", "STAB1"}, Component::exciter, "IEEET1.KA"},
               {{"IEEET1", "STAB1"}, Component::exciter, "STAB1.KT"},
               {{"TGOV1"}, Component::governor, "TGOV1.R"},
               {{"SEXS", "TGOV1"}, Component::machine, "GENROU.Xdp"}};
  for (const auto& c : cases) {
    double truth = 0;
    const CalibratedParameter p = found(c.controls, c.component, c.parameter, 1.4, truth);
    EXPECT_NEAR(p.fit.value, truth, 4 * p.fit.error) << c.parameter;
    EXPECT_LT(p.fit.error, 0.1 * truth) << c.parameter;
  }
}

}  // namespace
}  // namespace swingbank::validate::calibrate
