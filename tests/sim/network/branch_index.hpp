#pragma once
// Search of a branch by the numbers of its buses.
#include <string>

#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// Returns the index of the branch between two bus numbers (either direction) with this circuit id, or -1.
inline int branch_index(const Network& network, int from, int to, const std::string& circuit) {
  const int f = network.bus_index(from), t = network.bus_index(to);
  for (std::size_t i = 0; i < network.branches.size(); ++i) {
    const Branch& b = network.branches[i];
    if (((b.from == f && b.to == t) || (b.from == t && b.to == f)) && b.circuit == circuit)
      return static_cast<int>(i);
  }
  return -1;
}

}  // namespace swingbank::sim::network
