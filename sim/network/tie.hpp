#pragma once
// Ties: branches of nearly zero impedance, such as bus ties, jumpers, regulators and star legs entered as
// zero.
#include <string>
#include <vector>

#include "sim/network/event.hpp"

namespace swingbank::sim::network {

/// Least impedance |R + jX| of a branch [pu on base_mva]. The voltage drop of a branch with at most this
/// impedance (1e-5 pu at 10 pu current) is below the resolution of files and records. Such a branch gets the
/// impedance j kLeastImpedance.
constexpr double kLeastImpedance = 1e-6;
/// Largest impedance of a tie [pu on base_mva]; compare PSS/E's THRSHZ. A tie's current is computed from its
/// voltage difference or is an unknown of its own. If the tie's admittance were added to the admittances of
/// the bus's other branches, the digits of the latter would be lost. The resulting voltages would be wrong by
/// 1e-16 / |R + jX| pu.
constexpr double kTieImpedance = 1e-4;

/// Replaces an impedance up to kLeastImpedance by j kLeastImpedance, with a remark. `place`: the branch's
/// place in its file.
void raise_impedance(Network& network, double& r, double& x, const std::string& place);

/// A tie in service: V_from / ratio - V_to = z I. I flows into bus `to`, I / conj(ratio) out of bus `from`.
struct Tie {
  int from, to;      ///< bus indices
  Complex ratio, z;  ///< turns ratio [-]; series impedance z [pu]
};
/// Returns the ties of a topology.
std::vector<Tie> ties(const Network& network, const Topology& topology = {});
/// Returns whether the magnitude of the branch's impedance is at most kTieImpedance.
[[nodiscard]] bool is_tie(const Branch& branch);

}  // namespace swingbank::sim::network
