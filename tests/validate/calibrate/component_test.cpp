// A wrong parameter of an exciter, a governor or a machine alone, found from the component's records.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/validate/calibrate/one_wrong_parameter.hpp"
#include "tests/validate/playin/component_case.hpp"
#include "validate/calibrate/calibrate.hpp"
#include "validate/event/component_model.hpp"

namespace swingbank::validate::calibrate {
namespace {

using record::Component;

/// Two noisy events of a component; one parameter of the model is wrong.
void expect_found(const std::vector<std::string>& controls, Component component,
                  const std::string& parameter) {
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
  test::expect_found(event::component_model(std::move(model), component), std::move(records), parameter, 1.4);
}

TEST(CalibrateComponentTest, FindsWrongParametersWithinTheirIntervals) {
  const struct {
    std::vector<std::string> controls;
    Component component;
    std::string parameter;
  } cases[] = {{{"IEEET1", "STAB1"}, Component::exciter, "IEEET1.KA"},
               {{"IEEET1", "STAB1"}, Component::exciter, "STAB1.KT"},
               {{"TGOV1"}, Component::governor, "TGOV1.R"},
               {{"SEXS", "TGOV1"}, Component::machine, "GENROU.Xdp"}};
  for (const auto& c : cases) expect_found(c.controls, c.component, c.parameter);
}

}  // namespace
}  // namespace swingbank::validate::calibrate
