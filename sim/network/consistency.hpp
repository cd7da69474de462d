#pragma once
// What every reader of network files checks when all sections are in.
#include <functional>
#include <set>
#include <string>

#include "base/problem.hpp"
#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// Takes out of service what stands at an isolated bus (type 4): loads and shunts are removed, branches and
/// generators marked.
void settle_isolated(Network& network);
/// Star points of transformers with three windings, by index: one whose windings are all out hangs on
/// nothing.
void isolate_idle_stars(Network& network, const std::set<int>& stars);
/// Gives star points the voltage that those of their windings make: files often leave it at its default.
void settle_stars(Network& network, const std::set<int>& stars);
/// Equipment whose identity the file has already given and which is kept under a new id.
struct Duplicate {
  enum class Kind { load, shunt, generator, branch } kind;
  std::vector<int> buses;  ///< numbers of its buses, of a branch two or three
  std::string id{};        ///< the new one
  std::string text{};      ///< for remarks
};
struct Device;
/// Names the duplicates that are kept. With `by_voltages` one is kept only where the file's voltages balance
/// the powers at its buses better with it than without it; where they do not depend on it, it is kept. Buses
/// of devices are not judged.
void settle_duplicates(Network& network, const std::vector<Duplicate>& duplicates, bool by_voltages,
                       const std::vector<Device>& devices);
/// Settles what generators in service contradict each other about, with a remark for each. At a load bus
/// (type 1) a generator delivers its P and Q if the file's voltages show that power, else it is out of
/// service, as in PSS/E. Generators of one bus that hold different voltages or buses hold those of the first.
/// One that holds a bus out of service holds its own, at the file's voltage. Reactive limits that are crossed
/// are none. `where(i)`: place of generator i in the file.
void settle_generators(Network& network, const std::function<std::string(std::size_t)>& where);
/// Gives every island a slack bus, that of its largest generator by MVA, and takes islands without a
/// generator out of service (type 4), with remarks.
void settle_islands(Network& network);

/// Equipment without a model here: its kind and name, and the buses it stands at.
struct Device {
  std::string name, where;
  std::vector<int> buses;           ///< indices
  std::vector<double> scheduled{};  ///< power [pu] that it is to draw at each of them; NaN: not known
};
/// What stands in the place of equipment without a model.
enum class StandIn {
  checked,  ///< what the file's voltages say it draws; a problem where they are no solution elsewhere
  file,     ///< the same, whatever they leave elsewhere
  none      ///< nothing
};
/// Puts loads in the place of devices, with a remark.
void stand_in(Network& network, const std::vector<Device>& devices, StandIn how, Problems& problems);
/// Notes everything with a number that is not finite: quotients of extreme values. `file`: for messages.
void check_finite(const Network& network, const std::string& file, Problems& problems);

}  // namespace swingbank::sim::network
