#pragma once
// Simulation of a plant with its instruments (Plant::measurements): their errors are removed from the
// recorded voltage before playback, and applied to the response before the comparison.
#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Runs simulate_playback() with instruments. Their effect on a constant phasor is removed from the played-in
/// voltage and from the operating point. Their filtering of a moving phasor is not; samples within their
/// window around a step are left out of a fit instead (FitEvent::filtered_samples). An angle that was
/// integrated from a frequency is advanced by the lag of its measurement. The response's current is
/// filtered as in the instruments. The chain must be linear. Sensitivity parameters may include parameters of
/// the instruments, whose blocks follow those of sim::plant::block_parameters(). Their sensitivities are
/// central differences: of the instruments' outputs for one run of the plant if constant phasors pass as
/// before, else of whole runs. Throws InputError as simulate_playback().
Response observe(const PlaybackRun& run, std::span<const SensitivityParameter> parameters = {});

/// Returns whether the effect of instruments of this kind, away from null values, can be removed. It can if
/// their output is proportional to their input and deterministic (unlike noise or quantisation), and if they
/// change the voltage by at most a constant factor. A filter does not qualify: its window around steps is
/// left out instead.
bool can_be_taken_back(const sim::Effect& instrument);
/// Returns whether instruments of this kind change what a playback uses: V or I, and thereby P and Q, or an
/// angle that was integrated from a frequency, if the records have one.
bool changes_playback(const sim::Effect& instrument, bool integrated_angle);

}  // namespace swingbank::validate::playin
