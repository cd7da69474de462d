#pragma once
// Events made ready for fitting: where the voltage jumps, where the model starts, and how large the noise is
// in each channel.
#include <optional>
#include <vector>

#include "sim/plant/under_test.hpp"
#include "validate/event/whitened_events.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::event {

/// What an instrument does to jumps: it smears all or none.
enum class Jumps { either, sharp, spread };

struct FitEventOptions {
  bool measured_states = true;  ///< compare speed, Efd and Ifd too, where they are recorded
  double jump_threshold = playin::kJumpThreshold;
  double pre_event = 1.0;       ///< length of the steady window where nothing is switched [s]
  Jumps jumps = Jumps::either;  ///< either: the records tell (jumps_of)
  double mva = 0;               ///< of all machines whose power the records hold; 0: the model's
  /// P and Q at which the model stands, where the records' are those of several units [pu on their base]. An
  /// integrated angle's turns are then left to whoever knows all of them.
  std::optional<Complex> start = {};
};

/// The records in which jumps are sought. An angle that was integrated from a frequency does not show them,
/// but the power that flows over the transient reactance does: the angle is that of the voltage as the rotor
/// sees it then, which is theta = -0.3 P on a machine of so many MVA. Others stay as they are.
std::vector<record::Record> seen_by_rotor(std::vector<record::Record> records, double mva);

/// Samples about a switching that a meter's window reaches, whose frequency is then not that of the angle.
constexpr double kPeakReach = 2.1;

/// Finds switchings even where a filter has spread their jumps over two or three sample intervals. `smeared`
/// gets a mark for each sample that lies inside such a jump or beside it. If jumps are known to be spread,
/// the neighbours of sharp ones are marked too; if they are known to be sharp, a spread step is a swing.
std::vector<playin::Switching> find_switchings(const record::Record& record, double threshold, Jumps jumps,
                                               std::vector<char>& smeared);

/// What one instrument does to jumps, by all of its records: an instrument's filter is even, so it smears
/// before and after a jump alike, and what decays only after it is the machine's subtransient. Their first
/// jumps decide, because later ones may be those of a swing. Where some look sharp and others do not, the
/// most probable window does (passed_filter). `either` where no record tells. Where the angle was integrated,
/// V alone tells.
Jumps jumps_of(const std::vector<record::Record>& records, double threshold);

/// Prepares records that belong together (one plant, one instrument). The noise is that of the pre-event
/// residual of `model`, pooled over the events: what the played-in voltage's own noise adds through the
/// machine's reactance is in it, and so is what ties P and Q together. `kLeastNoise` is its floor. Throws
/// InputError if a record has no pre-event.
WhitenedEvents prepare_events(const plant::PlantModel& model, std::vector<record::Record> records,
                              const FitEventOptions& options = {});

/// Samples of the steady state before the first switching, as prepare_events() finds them, without a model.
/// `options.mva` is needed where the angle was integrated. Throws InputError if there are none.
int samples_before_event(const record::Record& record, const FitEventOptions& options);

/// Measures the noise anew with another model of the plant, because a reactance that is wrong by a fifth
/// makes the noise wrong by a fifth. The noise is white.
NoiseModel measure_noise(const sim::plant::PlantUnderTest& tested, const WhitenedEvents& events);

/// Interpolation between samples leaves residuals of this size where a record has no noise at all [pu].
constexpr double kLeastNoise = 1e-4;
/// The same for the speed [pu]. It is what an error of 1e-4 pu of P that lasts a tenth of a second does to a
/// machine of H = 1 s.
constexpr double kLeastSpeedNoise = 5e-6;

}  // namespace swingbank::validate::event
