#pragma once
// Simulation of a plant with its instruments (Plant::measurements): their errors are removed from the
// recorded voltage before playback, and applied to the response before the comparison.
#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Oversampling factor of a response for instruments with memory (filters). At the record's own rate, a step
/// of the response would extend over a whole sample interval before it is filtered.
inline constexpr int kOversampling = 8;

/// Runs simulate_playback() with instruments, whose chain must be linear. Their influence on a constant
/// phasor is removed from the played-in voltage and from the operating point. Their filtering of a changing
/// phasor is not removed. Instead, fits exclude the samples within the filter window around a step
/// (FitEvent::filtered_samples). An angle that was integrated from a frequency is advanced by the lag of its
/// measurement. P and Q of the response are those at the output of the instruments.
///
/// Sensitivity parameters may include parameters of the instruments, whose blocks follow those of
/// sim::plant::block_parameters(). Their sensitivities are central differences of the instruments' outputs
/// for one run of the plant. If the parameter changes the gain for constant phasors or the lag of the angle,
/// they are central differences of whole runs. Throws InputError as simulate_playback().
Response observe(const PlaybackRun& run, std::span<const SensitivityParameter> parameters = {});

/// Returns whether the influence of an instrument with parameters away from their null values can be removed.
/// This requires an output that is proportional to the input and deterministic (unlike noise or
/// quantisation), and that changes the voltage by a constant factor only. A filter does not meet this
/// requirement, so fits exclude the samples within its window around steps.
bool can_be_taken_back(const sim::Effect& instrument);
/// Returns whether an instrument changes quantities that a playback uses: V or I, and thereby P and Q. If
/// `integrated_angle`, an angle that was integrated from a frequency is included.
bool changes_playback(const sim::Effect& instrument, bool integrated_angle);

}  // namespace swingbank::validate::playin
