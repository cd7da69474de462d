// The README's example: the plant model without its exciter, and its records.
#pragma once
#include <fmt/format.h>

#include "sim/library/library.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::validate::calibrate::readme {

inline sim::plant::Block sexs(double gain_ratio, double gain, double TB, double TE) {
  return {sim::library::compiled().find("SEXS"), {gain_ratio, TB, gain, TE, -4.0, 5.0}};
}

inline plant::PlantModel example() {
  return plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
}

/// Record of event k, from 1 on.
inline record::Record example_record(const plant::PlantModel& model, int k) {
  return record::read_record(test::source(fmt::format("configs/records/record-example/avr_ev{}.csv", k)),
                             model.record_base);
}

inline std::vector<record::Record> example_records(const plant::PlantModel& model, int count) {
  std::vector<record::Record> records;
  for (int k = 1; k <= count; ++k) records.push_back(example_record(model, k));
  return records;
}

}  // namespace swingbank::validate::calibrate::readme
