#pragma once
// The README's example for tests: a plant without its exciter, and the first of its events.
#include "tests/validate/playin/support.hpp"
#include "validate/compare/compare.hpp"
#include "validate/compare/report.hpp"

namespace swingbank::validate::compare {

inline plant::PlantModel example_model() {
  return plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
}
inline EventComparison example_event(std::vector<double> switched = {}, const CompareOptions& options = {}) {
  const plant::PlantModel model = example_model();
  record::Record record =
      record::read_record(test::source("configs/records/record-example/avr_ev1.csv"), model.record_base);
  record.switched = std::move(switched);
  return compare_event(model, std::move(record), options);
}
inline Fitness fitness_of(const std::vector<EventComparison>& events) {
  return judge_fitness(events, 100, thresholds::read_acceptance(""));
}

}  // namespace swingbank::validate::compare
