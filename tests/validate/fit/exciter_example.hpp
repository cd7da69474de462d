#pragma once
// An example event and its plant, with an exciter whose lower limit is never reached.
#include "sim/library/library.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/fit/fit.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::fit {

/// Response of the plant to the event from the state `at`.
inline playin::Response response_to(const event::FitEvent& e, const EventState& at,
                                    const sim::plant::PlantUnderTest& tested) {
  return event::play(tested, e, at);
}

struct ExciterExample {
  plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  noise::WhitenedEvents events;
  double prior_sd;  ///< prior relative standard deviation of every parameter
  /// `TE` of the exciter [s]; the true value is 0.05.
  explicit ExciterExample(double believed, double TE = 0.05) : prior_sd(believed) {
    model.plant.controls.push_back({sim::library::compiled().find("SEXS"), {0.1, 10, 100, TE, -4.0, 5.0}});
    record::Record r =
        record::read_record(test::source("configs/records/record-example/avr_ev1.csv"), model.record_base);
    events = noise::whitened_events(model, {r}, {.measured_states = false});
  }
  [[nodiscard]] std::vector<FreeParameter> free(const std::vector<std::string>& names) const {
    std::vector<FreeParameter> some;
    for (const auto& f : free_parameters(model.plant, prior_sd))
      if (std::ranges::count(names, parameter_record(model.plant, f.id).name) > 0) some.push_back(f);
    return some;
  }
  [[nodiscard]] Fit fitted(const std::vector<std::string>& names, const FitOptions& options = {}) const {
    return fit(model.under_test(), events, free(names), options);
  }
};

}  // namespace swingbank::validate::fit
