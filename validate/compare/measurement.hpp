#pragma once
// Record of one event as it is compared with models: what the model does not determine is computed once.
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "validate/compare/compare.hpp"
#include "validate/event/event.hpp"

namespace swingbank::validate::compare {

/// A record that is compared with one or more models of the same machine: its samples until
/// `options.play_in.until`, the shape of its steps, and its switching times with the voltage about them.
/// Immutable; copies share the results.
class Measurement {
 public:
  /// `step_shape`: of the steps, or `either`: determined from this record. `mva`: rating of the machine.
  /// Throws InputError if too few samples remain.
  Measurement(record::Record record, const CompareOptions& options, double mva);

  /// Returns the record, cut to the compared samples.
  [[nodiscard]] const record::Record& record() const { return record_; }
  /// Returns the shape of the steps as the instrument recorded them.
  [[nodiscard]] switching::StepShape step_shape() const { return how_.step_shape; }
  /// Returns the record with its switching times and the voltage reconstructed about them, as a fit needs it.
  /// Computed at the first call. Throws InputError if the record has no angle.
  [[nodiscard]] const switching::SwitchedRecord& switched() const;
  /// Returns the options of switched(), for the rest of the preparation.
  [[nodiscard]] const event::FitEventOptions& preparation() const { return how_; }

 private:
  struct Found {
    std::once_flag once;
    std::optional<switching::SwitchedRecord> switched;
  };
  record::Record record_;
  event::FitEventOptions how_;
  std::shared_ptr<Found> found_ = std::make_shared<Found>();
};

/// Returns the measurements of records of one instrument, whose steps have one shape. Throws as Measurement.
std::vector<Measurement> measurements(const std::vector<record::Record>& records, CompareOptions options,
                                      double mva);

}  // namespace swingbank::validate::compare
