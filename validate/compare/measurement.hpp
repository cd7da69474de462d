#pragma once
// Record of one event for comparison with models; results that do not depend on the model are computed once.
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "validate/compare/compare.hpp"
#include "validate/event/event.hpp"

namespace swingbank::validate::compare {

/// Record for comparison with one or more models of the same machine: its samples until
/// `options.play_in.until`, the shape of its steps, and its switching times with the reconstructed voltage.
/// Immutable; copies share the results.
class Measurement {
 public:
  /// `options.step_shape`: shape of the steps; `either`: it is determined from this record. `mva`: rating of
  /// the machine [MVA]. Throws InputError if too few samples remain.
  Measurement(record::Record record, const CompareOptions& options, double mva);

  /// Returns the record, cut to the compared samples.
  [[nodiscard]] const record::Record& record() const { return record_; }
  /// Returns the shape of the steps as the instrument recorded them.
  [[nodiscard]] switching::StepShape step_shape() const { return how_.step_shape; }
  /// Returns the record with its switching times and the voltage reconstructed around them, for a fit.
  /// Computed at the first call. Throws InputError if the record has no angle.
  [[nodiscard]] const switching::SwitchedRecord& switched() const;
  /// Returns the options of switched(), for event::prepare_events().
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
