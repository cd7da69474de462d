#pragma once
// What every reader of network files checks when all sections are in.
#include <functional>
#include <string>

#include "base/problem.hpp"
#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// Takes out of service what stands at an isolated bus (type 4): loads and shunts are removed, branches and
/// generators marked.
void settle_isolated(Network& network);
/// Notes every generator in service at a load bus (type 1) and every bus whose generators hold different
/// voltages. `where(i)`: place of generator i in the file.
void check_held_voltages(const Network& network, const std::function<std::string(std::size_t)>& where,
                         Problems& problems);
/// Notes everything with a number that is not finite: quotients of extreme values. `file`: for messages.
void check_finite(const Network& network, const std::string& file, Problems& problems);

}  // namespace swingbank::sim::network
