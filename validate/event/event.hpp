#pragma once
// Preparation of events for fitting: switching times, operating point and noise of each channel.
#include <optional>
#include <vector>

#include "sim/plant/under_test.hpp"
#include "validate/event/whitened_events.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::event {

/// Shape of voltage steps as the instrument records them: all filtered, or none.
enum class StepShape { either, sharp, filtered };

/// Options of the preparation of records for fitting.
struct FitEventOptions {
  bool measured_states = true;  ///< compare speed, Efd and Ifd too, if recorded
  double step_threshold = playin::kStepThreshold;
  ///< threshold of playin::detect_switchings [pu]
  double pre_event = 1.0;  ///< length of the steady window of a record without switchings [s]
  StepShape step_shape = StepShape::either;  ///< either: determined from the records (step_shape_of)
  double mva = 0;  ///< rating of all machines whose power the records contain; 0: the model's
  /// P and Q of the model's operating point if the records contain the power of several units [pu on their
  /// base]. The caller, who has the models of all units, then estimates the turns of an integrated angle.
  std::optional<Complex> start = {};
};

/// Returns the records for the detection of switchings. An angle integrated from a frequency lacks their
/// steps, but the power through the transient reactance shows them. Such an angle is replaced by that of the
/// voltage seen from the rotor, theta = -0.3 P [pu on `mva`]. Other records are returned unchanged.
std::vector<record::Record> seen_by_rotor(std::vector<record::Record> records, double mva);

/// Reach of a meter's window around a switching [samples]: there the frequency is not the derivative of the
/// angle.
constexpr double kPeakReach = 2.1;

/// Finds switchings, also if a filter has spread their steps over two or three sample intervals. Marks in
/// `filtered_samples` each sample inside or next to such a filtered step. With StepShape::filtered, the
/// neighbours of sharp steps are marked too; with StepShape::sharp, a step over several intervals is taken
/// for a swing and ignored.
std::vector<playin::Switching> find_switchings(const record::Record& record, double threshold,
                                               StepShape step_shape, std::vector<char>& filtered_samples);

/// Returns the shape of steps as one instrument records them, from all of its records. The window of a filter
/// is even: it spreads a step equally before and after it. A decay on one side only is the machine's
/// subtransient response. The first step of each record decides, because later ones may belong to swings. If
/// some are sharp and others are not, the most probable window decides (passed_filter). `either` if no record
/// decides. If the angle was integrated, only V is used.
StepShape step_shape_of(const std::vector<record::Record>& records, double threshold);

/// Prepares the records of one plant and one instrument. The noise covariance is that of the pre-event
/// residual of `model`, pooled over the events. It thus includes the voltage noise transferred through the
/// machine's reactance, and the correlation of P and Q. `kLeastNoise` is its floor. Throws InputError if a
/// record has no pre-event window.
WhitenedEvents prepare_events(const plant::PlantModel& model, std::vector<record::Record> records,
                              const FitEventOptions& options = {});

/// Returns the number of samples in steady state before the first switching, as in prepare_events(), without
/// a model. `options.mva` is required if the angle was integrated. Throws InputError if there are none.
int samples_before_event(const record::Record& record, const FitEventOptions& options);

/// Estimates the noise again with another model of the plant; the noise is white. An error of a fifth in a
/// reactance causes an error of a fifth in the noise.
NoiseModel measure_noise(const sim::plant::PlantUnderTest& tested, const WhitenedEvents& events);

/// Noise floor [pu]: residual of the interpolation between samples in a record without noise.
constexpr double kLeastNoise = 1e-4;
/// Noise floor of the speed [pu]: effect of an error of 1e-4 pu of P that lasts 0.1 s on a machine of H = 1
/// s.
constexpr double kLeastSpeedNoise = 5e-6;

}  // namespace swingbank::validate::event
