// A parameter outside its usual range is fitted from its value, and may move further outside.
#include <gtest/gtest.h>

#include "tests/validate/calibrate/example.hpp"
#include "validate/calibrate/calibrate.hpp"
#include "validate/calibrate/curve_fit.hpp"

namespace swingbank::validate::calibrate {
namespace {

/// The README's plant with its exciter, on a quarter of its base: H is four times as large. The model's H is
/// already beyond its usual range (20 s), but still too small.
struct Quarter {
  plant::PlantModel model = readme::example();
  double H = 0;
  Quarter() {
    model.plant.controls.push_back(readme::sexs(0.1, 100, 10, 0.05));
    model.plant.mva /= 4;
    for (const char* reactance : {"Xd", "Xq", "Xdp", "Xqp", "Xdpp", "Xl"}) value(reactance) /= 4;
    H = 4 * value("H");
    value("H") = 22.0;
  }
  double& value(const char* name) {
    sim::plant::Block& machine = model.plant.machine;
    return machine.p[static_cast<std::size_t>(machine.effect->parameter_index(name))];
  }
  [[nodiscard]] std::vector<std::string> all_but_inertia() const {
    std::vector<std::string> names;
    for (const auto& f : fit::free_parameters(model.plant, 0.2))
      if (const auto name = sim::plant::parameter_name(model.plant, f.id); name.parameter != "H")
        names.push_back(name.text());
    return names;
  }
};

template <class Parameter>
void expect_found(const Parameter& p, double expected, double within) {
  EXPECT_NEAR(p.value, expected, within * expected);
  EXPECT_LT(p.low, p.value);
  EXPECT_GT(p.high, p.value);
  EXPECT_FALSE(p.at_bound);
}

TEST(CalibrateUnusual, MovesValueFurtherBeyondItsRange) {
  const Quarter q;
  CalibrateOptions options;
  options.events.measured_states = false;
  options.draws = options.starts = 0;
  options.fixed = q.all_but_inertia();
  const Calibration c = calibrate(q.model, readme::example_records(q.model, 2), options);
  ASSERT_EQ(c.parameters.size(), 1U);
  expect_found(c.parameters[0].fit, q.H, 0.02);
}

TEST(CurveFitUnusual, MovesValueFurtherBeyondItsRange) {
  const Quarter q;
  CurveFitOptions options;
  options.fixed = q.all_but_inertia();
  const CurveFit f = curve_fit(q.model, readme::example_records(q.model, 2), options);
  ASSERT_EQ(f.parameters.size(), 1U);
  expect_found(f.parameters[0], q.H, 0.05);  // 3.3 %: the baseline fits no switching times
}

}  // namespace
}  // namespace swingbank::validate::calibrate
