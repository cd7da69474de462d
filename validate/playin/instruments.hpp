#pragma once
// A driven plant as its own instruments show it (Plant::measurements): the recorded voltage is freed of their
// errors before it is played in, and the answer goes through them before it is compared.
#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::playin {

/// Runs drive() between instruments. What they make of a standing phasor is taken back from the played
/// voltage and from the operating point. How they smear a moving phasor is not taken back; their window
/// around a jump is left out of a fit instead (FitEvent::smeared). The answer's current is smeared as they
/// do. The chain must be linear. Directions may also be parameters of the instruments, whose blocks follow
/// those of sim::plant::block_parameters(); slopes along these are central differences (of
/// what the instruments make of one run of the plant, where standing phasors pass as before). Throws
/// InputError as drive().
Response observe(const Drive& run, std::span<const Direction> directions = {});

/// Whether what instruments of this kind do, away from neutral, can be taken back: they answer twice the
/// phasors by twice the answer and without chance (a noise or a quantisation does not), and change the
/// voltage by a constant factor at most (a filter smears it; its window around jumps is left out instead).
bool can_be_taken_back(const sim::Effect& instrument);
/// Whether instruments of this kind change V or I at all, and with them P and Q; one that makes frequency
/// does not.
bool touches_phasors(const sim::Effect& instrument);

}  // namespace swingbank::validate::playin
