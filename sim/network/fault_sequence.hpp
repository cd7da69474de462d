#pragma once
// Unbalanced faults in a positive-sequence simulation: the impedance the positive sequence sees at the fault,
// from the negative- and zero-sequence impedances of the grid there (symmetrical components; Kundur, Power
// System Stability and Control, 1994, section 13.4).
#include <optional>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "sim/network/event.hpp"
#include "sim/network/powerflow.hpp"

namespace swingbank::sim::network {

enum class FaultType { three_phase, line_to_ground, two_phase, two_phase_to_ground };
/// "3ph", "slg", "ll", "llg"; none for any other text.
std::optional<FaultType> fault_type(const std::string& name);
/// Whether the zero sequence carries current.
constexpr bool to_ground(FaultType type) {
  return type == FaultType::line_to_ground || type == FaultType::two_phase_to_ground;
}

/// z2, z0: of the grid at the fault, without it; zf: between phase and ground, between the two phases, or
/// between the joined phases and ground. All on one base; z0 is not read where no current flows to ground.
Complex fault_impedance(FaultType type, Complex z2, Complex z0, Complex zf);

/// A machine as the negative sequence sees it.
struct SequenceSource {
  int bus;             ///< index
  int generator;       ///< index into Network::generators
  Complex admittance;  ///< at the bus [pu on base_mva]
};
/// Driving-point impedance of the negative sequence at a bus [pu on base_mva]. Lines, shunts and loads have
/// their admittances of the positive sequence (a phase shift of the other sign does not change the diagonal);
/// every machine has its subtransient impedance.
Complex negative_sequence_impedance(const Network& network, const PowerFlow& flow, const Topology& topology,
                                    const std::vector<SequenceSource>& sources, int bus);

/// Turns the event's one fault, whose z is taken as zf, into the shunt the positive sequence sees. What was
/// switched at or before the start of the fault counts. Problems: more than one fault, something switched
/// during it (the negative sequence would change), z0 missing, or given where nothing reads it.
void make_unbalanced(Event& event, FaultType type, std::optional<Complex> z0, const Network& network,
                     const PowerFlow& flow, const std::vector<SequenceSource>& sources, Problems& problems);

}  // namespace swingbank::sim::network
