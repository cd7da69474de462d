#pragma once
// An example event and its plant, with an exciter whose lower limit is never met.
#include "support.hpp"
#include "validate/fit.hpp"

namespace swingbank::validate {

struct ExciterExample {
  PlantModel model = load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  std::vector<FitEvent> events;
  double spread;  ///< believed of every parameter
  /// TE [s] of the exciter; 0.05 is true.
  explicit ExciterExample(double believed, double TE = 0.05) : spread(believed) {
    model.plant.controls.push_back({sim::find_effect("SEXS"), {0.1, 10, 100, TE, -4.0, 5.0}});
    Record r = read_record(test::source("configs/records/record-example/avr_ev1.csv"), model.record_base);
    events = prepare_events(model, {r}, {.measured_states = false});
  }
  [[nodiscard]] std::vector<FreeParameter> free(const std::vector<std::string>& names) const {
    std::vector<FreeParameter> some;
    for (const auto& f : free_parameters(model.plant, spread))
      if (std::ranges::count(names, parameter_record(model.plant, f.block, f.index).name) > 0)
        some.push_back(f);
    return some;
  }
  [[nodiscard]] Fit fitted(const std::vector<std::string>& names, const FitOptions& options = {}) const {
    return fit(model.plant, model.conventions, events, free(names), options);
  }
};

}  // namespace swingbank::validate
