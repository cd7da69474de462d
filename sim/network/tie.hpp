#pragma once
// Branches of next to no impedance: bus ties, jumpers, regulators and star legs that are entered as zero.
#include <string>
#include <vector>

#include "sim/network/event.hpp"

namespace swingbank::sim::network {

/// Least impedance |R + jX| of a branch [pu on base_mva]. One that is not above it carries its current at a
/// voltage drop that no file and no record resolves (1e-5 pu at 10 pu), and gets j kLeastImpedance.
constexpr double kLeastImpedance = 1e-6;
/// Up to this impedance [pu on base_mva] a branch is a tie: its current is computed from the difference of
/// its voltages, or is an unknown of its own. A sum with its admittance would lose the digits of the other
/// branches at the bus: the voltages that follow from it are wrong by 1e-16 / |R + jX| pu. As PSS/E's THRSHZ.
constexpr double kTieImpedance = 1e-4;

/// Makes an impedance up to kLeastImpedance j kLeastImpedance, with a remark. `place`: where the branch is in
/// its file.
void raise_impedance(Network& network, double& r, double& x, const std::string& place);

/// A tie in service: V_from / ratio - V_to = z I. I flows into bus `to`, I / conj(ratio) out of bus `from`.
struct Tie {
  int from, to;  ///< bus indices
  Complex ratio, z;
};
/// The ties of a topology.
std::vector<Tie> ties(const Network& network, const Topology& topology = {});
[[nodiscard]] bool is_tie(const Branch& branch);

}  // namespace swingbank::sim::network
