#pragma once
// The transformers between a unit and the bus where its records are taken: one, several in parallel, in
// series, or two windings of a three-winding transformer.
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::grid {

/// V_machine = V_far / ratio + z I_machine, I_far = I_machine / ratio [pu on the network's base].
struct StepUp {
  Complex z{};
  double ratio = 1.0;
  /// Indices of the branches, from the machine on; those of one stage are in parallel.
  std::vector<std::vector<std::size_t>> stages;
  std::vector<int> buses;    ///< from the machine's to the last one, one more than stages
  bool same_ratio = true;    ///< of the branches of each stage
  bool magnetising = false;  ///< one of them has a magnetising admittance, which is left out
  [[nodiscard]] bool found() const { return !stages.empty(); }
};

/// The shortest way through transformers in service; without stages where there is none. `first`: impedance
/// and ratio that stand before it at the machine.
StepUp step_up(const network::Network& network, int machine, int far, const StepUp& first);
/// Whether what is connected to a bus on the way, beside `way`, may carry current: a generator, a load, a
/// shunt, or a branch in service that leads on. `text`: what it is, "" for nothing.
std::string joins_on_the_way(const network::Network& network, const StepUp& way, int bus);

}  // namespace swingbank::sim::grid
