#pragma once
// An event of a plant whose model lacks the exciter.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/validate/fit/exciter_example.hpp"
#include "validate/hypothesis/search.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::hypothesis {

class HiddenExciter : public ::testing::Test {
 protected:
  /// Sets P and Q of the event to the response of this plant.
  void record_response_of(const sim::plant::PlantUnderTest& truth) {
    event::FitEvent e = events_.front();
    const playin::Response r = fit::response_to(e, base_.events.front().state, truth);
    e.record.P = r.of(playin::Output::P);
    e.record.Q = r.of(playin::Output::Q);
    events_ = {{e}, events_.noise_model()};
  }
  [[nodiscard]] Hypothesis named(const std::string& name) const {
    const auto all = all_hypotheses(model_.under_test(), model_.library);
    return *std::ranges::find(all, name, &Hypothesis::name);
  }
  /// Parameter of the block that the hypothesis adds.
  static double& parameter(sim::plant::Plant& plant, std::string_view name) {
    sim::plant::Block& exciter = plant.controls.back();
    const auto& known = exciter.effect->parameters;
    const auto at = std::ranges::find(known, name, &sim::Parameter::name);
    return exciter.p[static_cast<std::size_t>(at - known.begin())];
  }
  const plant::PlantModel model_ = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  noise::WhitenedEvents events_ = noise::whitened_events(
      model_,
      {record::read_record(test::source("configs/records/record-example/avr_ev1.csv"), model_.record_base)},
      {.measured_states = false});
  fit::Fit base_ = fit::fit(model_.under_test(), events_, {}, {.iterations = 0});
  const BaseModel base_model_{.events = events_,
                              .plant = model_.plant,
                              .conventions = model_.conventions,
                              .library = model_.library,
                              .fit = base_};
};

}  // namespace swingbank::validate::hypothesis
