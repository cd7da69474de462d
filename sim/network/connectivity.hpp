#pragma once
// Islands of the network.
#include <string>
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// Returns the island number of each bus, counted from 0 in order of buses; -1 for an isolated bus (type 4).
/// `open`: sorted indices of open branches, besides those out of service.
std::vector<int> islands(const Network& network, const std::vector<int>& open = {});
/// Returns "bus 7" or "buses 7, 8, 9" for messages.
std::string bus_list(const Network& network, const std::vector<int>& buses);

}  // namespace swingbank::sim::network
