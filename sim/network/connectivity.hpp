#pragma once
// Which buses hang together.
#include <string>
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// Number of the island each bus lies in, counted from 0 in order of buses; -1 for an isolated bus (type 4).
/// `open`: branch indices taken out besides those out of service, sorted.
std::vector<int> islands(const Network& network, const std::vector<int>& open = {});
/// "bus 7" or "buses 7, 8, 9" for messages.
std::string bus_list(const Network& network, const std::vector<int>& buses);

}  // namespace swingbank::sim::network
