#pragma once
// Comparison of the measured and simulated channels of one event, per time window and relative to the noise.
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "validate/compare/error_map.hpp"
#include "validate/event/play.hpp"
#include "validate/event/progress.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/playin/play_in.hpp"
#include "validate/record/record.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::validate::compare {

/// Errors in one time window; residual = modelled - measured.
struct WindowError {
  int samples = 0;                 ///< number of compared samples
  double rms = 0, mean = 0;        ///< [pu on the record's base]
  double worst = 0, worst_at = 0;  ///< largest |residual| [pu] and its time [s]
  double in_noise = 0;             ///< rms / noise; NaN if the record has no noise
};
/// Measured and simulated time series of one channel, with its errors and noise.
struct ChannelComparison {
  std::string name, unit;                            ///< "P" in "MW", "speed" in "mHz"
  double scale = 1;                                  ///< value of 1 pu [unit]
  std::vector<double> measured, modelled, residual;  ///< [pu]
  double noise = 0;                  ///< standard deviation of the pre-event residual [pu]; 0: no noise found
  WindowError whole;                 ///< the whole record
  std::vector<WindowError> windows;  ///< one per window of the event
  ErrorMap map;                      ///< errors per window and band; judge() sets the bounds
  bool judged = true;                ///< the channel counts for the verdict
  double size = 1;                   ///< nominal value: the machine's MVA for a power, else 1 [pu]
};
/// Quantities that are played in.
enum class PlaybackInput {
  voltage,  ///< V and theta are played in; P and Q are compared
  power,    ///< P and Q are played in; V and the frequency of theta are compared
};
/// Result of compare_event().
struct EventComparison {
  record::Record record;                         ///< record, cut to the compared samples
  std::vector<switching::Switching> switchings;  ///< switching times that were used
  bool detected = false;                         ///< switching times were detected in the record, not given
  bool fitted = false;                      ///< switching times were fitted within their sample intervals
  std::vector<Window> windows;              ///< evaluation windows, in order of time
  playin::Playback playback;                ///< response of the model
  std::vector<ChannelComparison> channels;  ///< P, Q or V, frequency; speed, Efd, Ifd, Pm, gate, if recorded
  /// 1 for samples that are not compared: lost samples, and samples within a step that the instrument
  /// filtered. Empty: all samples are compared.
  std::vector<char> left_out = {};
  /// Per channel: residuals that errors of the played-in quantities may cause, one standard deviation each
  /// [shape][sample] [pu].
  std::map<std::string, std::vector<std::vector<double>>> doubt = {};
  /// Event as it was played, for replay().
  std::shared_ptr<const event::FitEvent> prepared = {};
  event::EventState state = {};    ///< fitted quantities of `prepared`
  std::vector<std::string> notes;  ///< notes for the reader: uncertain switching times, drift, unread columns
};

class Measurement;

/// Options of a comparison.
struct CompareOptions {
  PlaybackInput input = PlaybackInput::voltage;       ///< inputs of the playback
  double step_threshold = switching::kStepThreshold;  ///< threshold of switching::detect_switchings [pu]
  /// Fits detected switching times to P and Q within their sample intervals. At 30 samples/s half an interval
  /// is 17 ms; in a fault this error alone causes a residual of eight times the noise. If the fit brings no
  /// improvement, the midpoint of the interval is kept.
  bool fit_switchings = true;
  switching::StepShape step_shape =
      switching::StepShape::either;  ///< shape of the steps; either: determined from the record
  /// Called before each step of the comparison with the next step and the numbers of completed and of all
  /// steps.
  event::Progress progress = {};
  playin::PlayInOptions play_in;  ///< samples after its `until` are left out of the comparison
};

/// Unit of a channel in reports, and its noise floor.
struct ChannelUnit {
  std::string name;  ///< unit, "MW"
  double scale;      ///< value of 1 pu [unit]
  double floor;      ///< noise floor from interpolation, for records without noise [pu]
};
/// Returns the unit of an output, given the record's bases.
ChannelUnit channel_unit(playin::Output output, const record::RecordBase& base);

/// Name, unit and evaluation rules of one channel.
struct ChannelRule {
  std::string name, unit;  ///< name of the channel; its unit
  double scale;            ///< value of 1 pu [unit]
  double floor;            ///< noise floor from interpolation, for records without noise [pu]
  bool starts_at_mean;     ///< the model starts at this channel's pre-event mean
  bool judged = true;      ///< whether the verdict uses the channel
  /// Name of a window that is not evaluated, because its noise differs from the pre-event noise; empty: none.
  std::string_view skip = {};
  double size = 1;  ///< nominal value: the machine's MVA for a power, else 1 [pu]
};
/// Computes the errors of a residual [pu] in one window. `first`: the window includes its start. `noise`:
/// standard deviation of the noise [pu].
WindowError window_error(const std::vector<double>& t, const std::vector<double>& residual,
                         const std::vector<char>& left_out, const Window& window, bool first, double noise);
/// Returns a channel with measured and modelled curves and their residual; the errors are not computed.
ChannelComparison channel_curves(const ChannelRule& rule, const std::vector<double>& measured,
                                 const std::vector<double>& modelled);
/// Computes residual, window errors and error map of one channel. Record, windows and playback.start of
/// `event` must be set; the noise is that of the first playback.start.samples residuals.
ChannelComparison compare_channel(const ChannelRule& rule, const std::vector<double>& measured,
                                  const std::vector<double>& modelled, const EventComparison& event);
/// Returns the frequency deviation [pu] of an angle [rad] by central differences.
std::vector<double> frequency_of(const std::vector<double>& t, const std::vector<double>& theta,
                                 double nominal);

/// Returns the time windows: pre-event, fault, and 0-1 s, 1-5 s and > 5 s after the last switching. The fault
/// window lies between the first and the last switching. With a single switching there is no fault window.
/// Without a switching, the windows count from the start of the record (0-1 s, 1-2 s, 2-6 s and > 6 s with a
/// pre-event of 1 s). Windows without a sample are omitted, and no window begins or ends with samples that
/// are left out.
std::vector<Window> event_windows(const record::Record& record,
                                  const std::vector<switching::Switching>& switchings, double pre_event,
                                  const std::vector<char>& left_out = {});

/// Plays the record into the model and computes the residuals. If P and Q are played in, no network fixes the
/// angle, so an error of P from noise before the event becomes a ramp of frequency. Frequency and speed are
/// then shown but not judged. Throws InputError if the record cannot be prepared or the simulation fails.
EventComparison compare_event(const plant::PlantModel& model, const Measurement& measurement,
                              const CompareOptions& options);
/// As above, for a record that is compared with one model.
EventComparison compare_event(const plant::PlantModel& model, record::Record record,
                              const CompareOptions& options = {});

/// Response of one channel in a repeated playback, without error map.
struct ReplayedChannel {
  std::vector<double> modelled;  ///< [pu]
  double noise = 0;              ///< standard deviation of the pre-event residual [pu]
  WindowError whole;             ///< error of the whole record
};
/// Plays an event of a comparison into a plant of the same structure with other parameter values. Switching
/// times and initial state are those of the comparison. Returns one entry for each channel of the event.
/// Takes a few milliseconds. Throws InputError as compare_event().
std::vector<ReplayedChannel> replay(const sim::plant::PlantUnderTest& tested, const EventComparison& event);

/// Statistical verdict: whether the residuals are within noise.
struct Adequacy {
  bool adequate = false;        ///< the residual is noise in every bin
  int bins = 0, exceeding = 0;  ///< bins of all maps and whole records; bins above their bound
  int vague = 0;                ///< bins in which noise alone may exceed the channel's nominal value
  std::string sentence;         ///< verdict, criterion and the bin nearest to its bound or furthest above it
  thresholds::Ruling ruling;    ///< ruling by Criterion::bins
};
/// Sets the bounds of all maps and judges the model. It is adequate if no time-frequency bin, no window over
/// all frequencies and no whole record exceeds its noise bound, at a joint false-alarm probability of
/// adequacy.false_alarm. If noise alone may exceed the nominal value in a bin, the verdict is undecided and
/// counts as not adequate. This occurs if the model is unstable in playback.
Adequacy judge(std::vector<EventComparison>& events);

}  // namespace swingbank::validate::compare
