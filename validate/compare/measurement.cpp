#include "validate/compare/measurement.hpp"

#include <limits>
#include <utility>

#include "validate/switching/switched_records.hpp"

namespace swingbank::validate::compare {

Measurement::Measurement(record::Record record, const CompareOptions& options, double mva)
    : record_(record::stretch(std::move(record), -std::numeric_limits<double>::infinity(),
                              options.play_in.until)),
      how_{.step_threshold = options.step_threshold,
           .pre_event = options.play_in.pre_event,
           .step_shape = options.step_shape == switching::StepShape::either
                             ? switching::step_shape_of({record_}, options.step_threshold)
                             : options.step_shape,
           .mva = mva} {}

const switching::SwitchedRecord& Measurement::switched() const {
  std::call_once(found_->once, [this] {
    found_->switched = std::move(event::reconstructed_records({record_}, how_).front());
  });
  return *found_->switched;
}

std::vector<Measurement> measurements(const std::vector<record::Record>& records, CompareOptions options,
                                      double mva) {
  options.step_shape = switching::step_shape_of(records, options.step_threshold);
  std::vector<Measurement> all;
  for (const record::Record& r : records) all.emplace_back(r, options, mva);
  return all;
}

}  // namespace swingbank::validate::compare
