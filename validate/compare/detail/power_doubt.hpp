#pragma once
// What the noise and the gaps of P and Q about a switching may do to a voltage that they drive: in a fault it
// answers to them many times as strongly as elsewhere, and the rotor keeps what it got there.
#include "validate/compare/compare.hpp"

namespace swingbank::validate::compare {

/// Sets EventComparison::doubt of an event whose playback is that of P and Q: by playing it in again with
/// each of these moved by what it may be off.
void add_power_doubt(const plant::PlantModel& model, const playin::PlayInOptions& options,
                     EventComparison& e);

}  // namespace swingbank::validate::compare
