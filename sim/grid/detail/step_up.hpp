#pragma once
// Transformers between a unit and its measured bus: one, several in parallel or in series, or two windings of
// a three-winding transformer.
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::grid {

/// V_machine = V_far / ratio + z I_machine, I_far = I_machine / ratio [pu on the network's base].
struct StepUp {
  Complex z{};
  double ratio = 1.0;
  /// Indices of the branches, starting at the machine; the branches of one stage are in parallel.
  std::vector<std::vector<std::size_t>> stages;
  std::vector<int> buses;    ///< buses of the path, from the machine's; one more than stages
  bool same_ratio = true;    ///< true if the parallel branches of every stage have equal ratios
  bool magnetising = false;  ///< true if a magnetising admittance was neglected
  [[nodiscard]] bool found() const { return !stages.empty(); }
};

/// Returns the shortest path through transformers in service, without stages if there is none. `first`:
/// impedance and ratio between the machine and its bus, included in the result.
StepUp step_up(const network::Network& network, int machine, int far, const StepUp& first);
/// Returns a description of other equipment at a bus of the path that may carry current, or "". Such
/// equipment is a generator, a load, a shunt, or a branch in service outside the path that leads to further
/// equipment or branches.
std::string joins_on_the_way(const network::Network& network, const StepUp& way, int bus);

}  // namespace swingbank::sim::grid
