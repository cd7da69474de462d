#pragma once
// Measured against modelled P and Q of one event, per window of time and beside the record's own noise.
#include <map>
#include <string>
#include <vector>

#include "validate/compare/error_map.hpp"
#include "validate/event/event.hpp"
#include "validate/event/progress.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/playin/play_in.hpp"
#include "validate/record/record.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::validate::compare {

/// Residual = modelled - measured.
struct WindowError {
  int samples = 0;
  double rms = 0, mean = 0;        ///< [pu on the record's base]
  double worst = 0, worst_at = 0;  ///< largest |residual| [pu] and its time [s]
  double in_noise = 0;             ///< rms / noise; NaN where the record has no noise
};
struct ChannelComparison {
  std::string name, unit;                            ///< "P" in "MW", "speed" in "mHz"
  double scale = 1;                                  ///< units in 1 pu
  std::vector<double> measured, modelled, residual;  ///< [pu]
  double noise = 0;                  ///< standard deviation of the pre-event residual [pu]; 0: none to see
  WindowError whole;                 ///< the whole record
  std::vector<WindowError> windows;  ///< one per window of the event
  ErrorMap map;                      ///< per window and band; bounds are set by judge()
  bool judged = true;                ///< counts for the verdict
  double size = 1;                   ///< of what is measured: the machine's MVA of a power [pu]
};
enum class DriveBy {
  voltage,  ///< V and theta drive, P and Q are compared
  power,    ///< P and Q drive, V and the frequency of theta are compared
};
struct EventComparison {
  record::Record record;
  std::vector<playin::Switching> switchings;
  bool detected = false;  ///< the switchings were found in the record, not given
  bool fitted = false;    ///< and moved within their sample intervals
  std::vector<Window> windows;
  playin::Playback playback;
  std::vector<ChannelComparison> channels;  ///< P, Q or V, frequency; speed, Efd, Ifd where recorded
  /// Marks samples that an instrument's filter has smeared over a switching; these are not compared. Empty:
  /// no sample is.
  std::vector<char> left_out = {};
  /// By channel: what the played-in voltage's errors may leave in the residual, one standard deviation each
  /// (VoltageDoubt) [shape][sample] [pu].
  std::map<std::string, std::vector<std::vector<double>>> doubt = {};
  std::vector<std::string> notes;  ///< what a reader must know: uncertain instants, drift, columns left out
};

struct CompareOptions {
  DriveBy drive = DriveBy::voltage;
  double jump_threshold = playin::kJumpThreshold;
  /// Moves found instants within their sample interval to where P and Q are met best, because a model is not
  /// to blame for what the record does not tell. At 30/s half an interval is 17 ms, and in a fault so much
  /// alone left eight times the noise of a right model. Where nothing is met better, the middle of the
  /// interval stays.
  bool fit_switchings = true;
  event::Jumps jumps = event::Jumps::either;  ///< what the instrument does to jumps; either: the record tells
  /// Told before each step of a record that is long: what comes, and how many steps are done of how many.
  event::Progress progress = {};
  playin::PlayInOptions play_in;  ///< samples after its `until` are left out of the comparison
};

/// How a channel is shown, and what computing it leaves where a record has no noise.
struct ChannelUnit {
  std::string name;
  double scale;  ///< units in 1 pu
  double floor;  ///< [pu]
};
ChannelUnit channel_unit(playin::Output output, const record::RecordBase& base);

/// What one channel is called and how it is judged.
struct ChannelRule {
  std::string name, unit;
  double scale;         ///< units in 1 pu
  double floor;         ///< what the computation leaves where a record has no noise [pu]
  bool starts_at_mean;  ///< the model starts at this channel's pre-event mean
  bool judged = true;
  std::string_view skip = {};  ///< window whose noise is not that before the event
  double size = 1;             ///< of what is measured: the machine's MVA of a power [pu]
};
/// Residual, windows and error map of one channel of an event whose record, windows and playback.start are
/// set; noise is that of the first playback.start.samples residuals.
ChannelComparison compare_channel(const ChannelRule& rule, const std::vector<double>& measured,
                                  const std::vector<double>& modelled, const EventComparison& event);
/// Frequency [pu deviation] of an angle, by central differences.
std::vector<double> frequency_of(const std::vector<double>& t, const std::vector<double>& theta,
                                 double nominal);

/// pre-event, fault, 0-1 s, 1-5 s and > 5 s after the last switching; where nothing switches, the same
/// lengths counted from the begin of the record (0-1 s, 1-2 s, 2-6 s and > 6 s of the record, with a
/// pre-event stretch of 1 s); none without a sample. Between the first and the last switching is the "fault";
/// a single switching has none. No window begins or ends with samples that are left out.
std::vector<Window> event_windows(const record::Record& record,
                                  const std::vector<playin::Switching>& switchings, double pre_event,
                                  const std::vector<char>& left_out = {});

/// Plays the record into the model and measures what is left. Where P and Q drive, no network holds the
/// angle: a constant error of P, which a noisy pre-event leaves, becomes a ramp of frequency. Frequency and
/// speed are then shown, not judged. Throws InputError as its parts do.
EventComparison compare_event(const plant::PlantModel& model, record::Record record,
                              const CompareOptions& options = {});

/// Is nothing but noise left?
struct Adequacy {
  bool adequate = false;
  int cells = 0, exceeding = 0;  ///< of all maps, the whole records included
  int vague = 0;                 ///< cells of which noise alone may leave more than the channel is large
  std::string sentence;          ///< verdict, criterion and the cell that is furthest off
  thresholds::Ruling ruling;     ///< Criterion::cells
};
/// Sets the bounds of all maps and judges by them: a model is adequate if every cell of every map, every
/// window over all frequencies and every channel's whole record stays within what noise allows, with
/// probability 1 - adequacy.false_alarm for all of them together. Where noise is allowed to leave more than
/// the machine is large, as in a model that runs away when it is driven, no record can tell, and the model is
/// not adequate.
Adequacy judge(std::vector<EventComparison>& events);

}  // namespace swingbank::validate::compare
