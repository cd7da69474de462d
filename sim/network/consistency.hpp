#pragma once
// Consistency checks and corrections common to all readers of network files, after all sections are read.
#include <functional>
#include <set>
#include <string>

#include "base/problem.hpp"
#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// Takes the equipment of isolated buses (type 4) out of service: removes loads and shunts, marks branches
/// and generators as out of service.
void settle_isolated(Network& network);
/// Isolates star points of three-winding transformers whose windings are all out of service. `stars`: bus
/// indices.
void isolate_idle_stars(Network& network, const std::set<int>& stars);
/// Computes the voltages of star points from the voltages at their windings' buses, because files often
/// contain only a default.
void settle_stars(Network& network, const std::set<int>& stars);
/// Equipment with an identity that the file has already used; it is kept under a new id.
struct Duplicate {
  enum class Kind { load, shunt, generator, branch } kind;  ///< kind of equipment
  std::vector<int> buses;  ///< numbers of its buses; two or three for a branch
  std::string id{};        ///< new id
  std::string text{};      ///< description in remarks
};
struct Device;
/// Keeps or removes each duplicate, and adds remarks. Without `by_voltages` all are kept. With `by_voltages`,
/// a duplicate is removed if, without it, the file's voltages balance the powers at its buses better. Buses
/// with devices are excluded from this balance.
void settle_duplicates(Network& network, const std::vector<Duplicate>& duplicates, bool by_voltages,
                       const std::vector<Device>& devices);
/// Resolves contradictions between generators in service, with a remark for each:
/// - At a load bus (type 1) a generator delivers its P and Q if the file's voltages confirm that power.
///   Otherwise it is out of service, as in PSS/E.
/// - If generators of one bus have different set-points or regulated buses, all take those of the first
///   generator.
/// - A generator whose regulated bus is out of service regulates its own bus, at the file's voltage.
/// - Reactive limits with q_min above q_max are removed.
/// `where(i)`: place of generator i in the file.
void settle_generators(Network& network, const std::function<std::string(std::size_t)>& where);
/// Makes slack buses without a generator in service load buses. In every island without a slack bus, makes
/// the bus of type 2 with the largest sum of machine bases [MVA] the slack bus. Takes islands without such a
/// bus out of service (type 4). Adds remarks.
void settle_islands(Network& network);

/// Equipment without a model in Swingbank: kind, name and buses.
struct Device {
  std::string name, where;          ///< kind and name, as text; its place in the file
  std::vector<int> buses;           ///< bus indices
  std::vector<double> scheduled{};  ///< scheduled consumption [pu] at each bus; NaN: unknown
};
/// Replacement of equipment without a model.
enum class DeviceReplacement {
  checked,  ///< loads computed from the file's voltages; a problem if these voltages are no solution at
            ///< other buses
  file,     ///< loads computed from the file's voltages, without that check
  none      ///< no replacement
};
/// Replaces devices by loads, with a remark. Errors are added to `problems`.
void replace_devices(Network& network, const std::vector<Device>& devices, DeviceReplacement how,
                     Problems& problems);
/// Adds a problem for each item with a value that is not finite, which a quotient of extreme numbers can
/// produce. `file`: name in messages.
void check_finite(const Network& network, const std::string& file, Problems& problems);

}  // namespace swingbank::sim::network
