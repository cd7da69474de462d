#pragma once
// Play-in: the recorded terminal voltage drives a plant's equations, and the P and Q they answer with are set
// beside the measured ones. No network is needed; what the network did is in the voltage.
#include <array>
#include <limits>
#include <vector>

#include "sim/plant/under_test.hpp"
#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::playin {

struct PlayInOptions {
  double tolerance = 1e-10;  ///< error per step, relative to 1 + |state|
  double pre_event = 1.0;    ///< length of the pre-event window where nothing was switched [s]
  double until = std::numeric_limits<double>::infinity();  ///< samples after it are left out [s]
  int step_limit = 2'000'000;                              ///< steps of the integrator before it gives up
};

/// Mean of the samples before the first switching, or of the first `pre_event` seconds where there is none;
/// where the angle bends, the courses at the first sample. Throws InputError if that leaves fewer than 5.
OperatingPoint pre_event_point(const record::Record& record, const std::vector<Switching>& switchings,
                               double pre_event);

/// What the model answered, at the record's instants up to `until`; per unit on the record's base, Efd and
/// Ifd on the machine's.
struct Playback {
  OperatingPoint start;
  std::vector<double> P, Q, speed, Efd, Ifd, Pm, gate;
  std::vector<double> V;  ///< at the machine's terminal, or the plant's where P and Q drive (play_in_power)
  std::vector<double> theta;  ///< where P and Q drive; unwrapped [rad]
  int steps = 0;              ///< of the integrator
};

/// Moves a response's outputs into a playback.
void take_outputs(Response& response, Playback& back);

/// Plays the curve into the plant; a component's record gives what else drives it. The plant starts in
/// equilibrium at the pre-event mean; empty exciter and governor slots hold Efd and Tm there. Where the
/// pre-event angle turns evenly, the frame turns with it. Throws InputError if the operating point cannot be
/// held, or the equations cannot be integrated (state and time are named).
Playback play_in(const sim::plant::PlantUnderTest& tested, const record::Record& record,
                 const VoltageCurve& curve, const PlayInOptions& options = {});

/// The reverse: P and Q of the record drive the plant, V and theta are its answer; P and Q stay empty. Throws
/// also where no terminal voltage delivers them.
Playback play_in_power(const sim::plant::PlantUnderTest& tested, const record::Record& record,
                       const std::vector<Switching>& switchings, const PlayInOptions& options = {});

}  // namespace swingbank::validate::playin
