#pragma once
// Preparation of records for fitting: switching times and operating point.
#include <optional>
#include <vector>

#include "validate/event/fit_event.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/switching/switched_records.hpp"

namespace swingbank::validate::event {

/// Options of the preparation of records for fitting.
struct FitEventOptions {
  bool measured_states = true;  ///< compare speed, Efd and Ifd too, if recorded
  double step_threshold = switching::kStepThreshold;
  ///< see switching::SwitchingOptions::threshold [pu]
  double pre_event = 1.0;  ///< length of the steady window of a record without switchings [s]
  switching::StepShape step_shape =
      switching::StepShape::either;  ///< shape of the steps; either: determined from the records
  double mva = 0;  ///< rating of all machines whose power the records contain [MVA]; 0: the model's
  /// P and Q of the model's operating point if the records contain the power of several units [pu on their
  /// base]. The caller, who has the models of all units, then estimates the phase jumps of an integrated
  /// angle.
  std::optional<Complex> start = {};
};

/// Prepares the records of one plant and one instrument. Their noise is estimated by
/// noise::whitened_events(). Throws InputError if a record has no pre-event window.
std::vector<FitEvent> prepare_events(const plant::PlantModel& model, std::vector<record::Record> records,
                                     const FitEventOptions& options = {});
/// Returns the records with switching times and reconstructed voltage. This part of the preparation does not
/// depend on the model's parameters. `options.mva` is required if an angle was integrated. Throws InputError
/// if a record that needs an angle has none. Records of an exciter or a governor, and tests in which the
/// breaker opens, need none.
std::vector<switching::SwitchedRecord> reconstructed_records(std::vector<record::Record> records,
                                                             const FitEventOptions& options);
/// Prepares the result of reconstructed_records(). Throws as the overload above.
std::vector<FitEvent> prepare_events(const plant::PlantModel& model,
                                     std::vector<switching::SwitchedRecord> records,
                                     const FitEventOptions& options);

/// Returns the number of samples in steady state before the first switching, as in prepare_events(), without
/// a model. `options.mva` is required if the angle was integrated. Throws InputError if there are fewer than
/// five.
int samples_before_event(const record::Record& record, const FitEventOptions& options);

}  // namespace swingbank::validate::event
