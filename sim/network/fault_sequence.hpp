#pragma once
// Unbalanced faults in a positive-sequence simulation: the equivalent shunt impedance at the fault, from the
// grid's negative- and zero-sequence impedances (symmetrical components; Kundur, Power System Stability and
// Control, 1994, section 13.4).
#include <optional>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "sim/network/event.hpp"
#include "sim/network/powerflow.hpp"

namespace swingbank::sim::network {

/// Type of a short circuit.
enum class FaultType { three_phase, line_to_ground, two_phase, two_phase_to_ground };
/// Returns the fault type for "3ph", "slg", "ll" or "llg"; empty for any other text.
std::optional<FaultType> fault_type(const std::string& name);
/// Whether the zero sequence carries current.
constexpr bool to_ground(FaultType type) {
  return type == FaultType::line_to_ground || type == FaultType::two_phase_to_ground;
}

/// Returns the shunt impedance in the positive sequence. z2, z0: negative- and zero-sequence impedances of
/// the unfaulted grid, seen from the faulted bus. zf: impedance between phase and ground, between the two
/// phases, or between the joined phases and ground. All on one base; z0 is read only for faults to ground.
Complex fault_impedance(FaultType type, Complex z2, Complex z0, Complex zf);

/// A machine in the negative-sequence network.
struct SequenceSource {
  int bus;             ///< bus index
  int generator;       ///< index into Network::generators
  Complex admittance;  ///< admittance between bus and source [pu on base_mva]
};
/// Returns the negative-sequence driving-point impedance at a bus [pu on base_mva]. Lines, shunts and loads
/// have their positive-sequence admittances; the opposite sign of phase shifts does not change the diagonal
/// of the impedance matrix. Every machine has its subtransient impedance.
Complex negative_sequence_impedance(const Network& network, const PowerFlow& flow, const Topology& topology,
                                    const std::vector<SequenceSource>& sources, int bus);

/// Replaces the event's single fault, whose impedance z is zf, by the equivalent positive-sequence shunt.
/// Switchings up to the start of the fault are included. Problems: none or more than one fault; a switching
/// during the fault, which would change the negative sequence; z0 missing, or given for a fault that does not
/// need it.
void make_unbalanced(Event& event, FaultType type, std::optional<Complex> z0, const Network& network,
                     const PowerFlow& flow, const std::vector<SequenceSource>& sources, Problems& problems);

}  // namespace swingbank::sim::network
