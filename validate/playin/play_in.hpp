#pragma once
// Play-in: simulation of a plant with the recorded terminal voltage as input. Its P and Q are compared with
// the measured ones. No network model is needed, because the voltage contains the network's effect.
#include <array>
#include <limits>
#include <vector>

#include "sim/plant/under_test.hpp"
#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Options of a playback.
struct PlayInOptions {
  double tolerance = 1e-10;  ///< error per step, relative to 1 + |state|
  double pre_event = 1.0;    ///< length of the pre-event window of a record without switchings [s]
  double until = std::numeric_limits<double>::infinity();  ///< later samples are not simulated [s]
  int step_limit = 2'000'000;                              ///< maximum number of integration steps
};

/// Returns the mean of the samples before the first switching or staged event. Without either, it is the mean
/// of the first `pre_event` seconds. If the pre-event angle is curved, the result is the trend of the
/// quantities at the first sample instead. Throws InputError if there are fewer than 5 samples.
OperatingPoint pre_event_point(const record::Record& record, const std::vector<Switching>& switchings,
                               double pre_event);

/// Response of the model at the record's samples up to `until`; per unit on the record's base, Efd and Ifd on
/// the machine's.
struct Playback {
  OperatingPoint start;                                 ///< operating point before the event
  std::vector<double> P, Q, speed, Efd, Ifd, Pm, gate;  ///< outputs [sample] [pu]
  std::vector<double> V;      ///< at the plant's terminal, the grid side of a step-up transformer
  std::vector<double> theta;  ///< if P and Q are the inputs; unwrapped [rad]
  int steps = 0;              ///< number of integration steps
};

/// Moves a response's outputs into a playback.
void take_outputs(Response& response, Playback& back);

/// Returns the plant's response to the curve, and to further inputs in a component's record. The plant starts
/// in equilibrium at the pre-event mean. Efd is constant without an exciter, and Tm is constant without a
/// governor. If the pre-event angle changes at a constant rate, the reference frame rotates at that rate.
/// Throws InputError if the operating point has no steady state, or if the integration fails (with the time).
Playback play_in(const sim::plant::PlantUnderTest& tested, const record::Record& record,
                 const VoltageCurve& curve, const PlayInOptions& options = {});

/// Returns the response V and theta to the record's P and Q as inputs; Playback::P and Q stay empty. Throws
/// InputError as play_in(), and if no terminal voltage delivers P and Q.
Playback play_in_power(const sim::plant::PlantUnderTest& tested, const record::Record& record,
                       const std::vector<Switching>& switchings, const PlayInOptions& options = {});

}  // namespace swingbank::validate::playin
