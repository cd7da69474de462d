// Reader of the substations of versions 34 and 35: nodes and switches inside the buses. In the other
// sections, the nodes that closed switches connect are one bus. A substation therefore adds no equations if
// the nodes of every bus are connected. A bus is refused if open switches split it, or if a closed switch
// joins it to another bus. Source: PSS/E data format manual, "Substation Data".
#include <functional>

#include "sim/formats/detail/psse_raw.hpp"

namespace swingbank::sim::formats::psse {

int RawReader::Substation::root(int node) const {
  while (nodes.at(node).root != node) node = nodes.at(node).root;
  return node;
}

/// Reads the rows of one of a substation's three blocks, up to '0'. Returns false if the file ends before
/// '0'.
bool RawReader::part_of_substation(const char* name, const std::function<void(const Record&)>& row) {
  while (auto record = next()) {
    if (ends_section(*record)) return true;
    if (ends_file(*record)) {
      put_back(*record);
      return false;
    }
    row(*record);
  }
  problems_.add(std::string("the file ends in the ") + name + " of a substation",
                file_ + ":" + std::to_string(lines_.size()), "the file is truncated", "restore the file");
  return false;
}

/// Reads node number, name, bus and STATUS.
void RawReader::node(Substation& station, const Record& record) {
  Fields f(record, file_, problems_);
  const int node = f.integer(0, "node number"), bus = f.integer(2, "bus number");
  find_bus(bus, f);
  status(f.integer(3, "STATUS", 1), "STATUS", f);
  if (!station.nodes.emplace(node, Substation::Node{bus, node}).second)
    problems_.add("node " + std::to_string(node) + " appears twice", f.where(),
                  "node numbers are unique within a substation", "remove one or give it another number");
}

/// Returns whether the substation has the node; if not, adds a problem.
bool RawReader::has_node(const Substation& station, int node, const Fields& f) {
  if (station.nodes.contains(node)) return true;
  problems_.add("node " + std::to_string(node) + " is not in the substation's nodes", f.where(),
                "the record refers to it", "add the node or correct the number");
  return false;
}

/// Reads two nodes, and STATUS in the sixth field.
void RawReader::node_switch(Substation& station, const Record& record) {
  Fields f(record, file_, problems_);
  const int a = f.integer(0, "from node"), b = f.integer(1, "to node");
  const bool closed = status(f.integer(5, "STATUS", 1), "STATUS", f),
             known = has_node(station, a, f) && has_node(station, b, f);
  if (known && closed) station.nodes.at(station.root(a)).root = station.root(b);
}

/// Reads bus and node of an equipment.
void RawReader::terminal(Substation& station, const Record& record) {
  Fields f(record, file_, problems_);
  const int bus = f.integer(0, "bus number"), node = f.integer(1, "node number");
  find_bus(bus, f);
  if (has_node(station, node, f)) station.terminals.emplace(node, f.where());
}

void RawReader::substation(const Record& first) {
  Substation station;
  station.name = Fields(first, file_, problems_).text(1, "");
  const auto with = [&](void (RawReader::*row)(Substation&, const Record&)) {
    return [this, &station, row](const Record& record) { (this->*row)(station, record); };
  };
  if (part_of_substation("nodes", with(&RawReader::node)) &&
      part_of_substation("switches", with(&RawReader::node_switch)) &&
      part_of_substation("terminals", with(&RawReader::terminal)))
    check_substation(station);
}

void RawReader::check_substation(const Substation& station) {
  std::map<int, int> piece_of, bus_of;  // bus -> root of its nodes with equipment; root -> bus
  for (const auto& [node, where] : station.terminals) {
    const int bus = station.nodes.at(node).bus, root = station.root(node);
    const auto [piece, fresh] = piece_of.emplace(bus, root);
    if (!fresh && piece->second != root)
      problems_.add("open switches split bus " + std::to_string(bus), where,
                    "sections of a bus in substation '" + station.name + "' are not modelled",
                    "close the switches or enter the sections as separate buses");
    const auto [owner, first] = bus_of.emplace(root, bus);
    if (!first && owner->second != bus)
      problems_.add(
          "closed switches join buses " + std::to_string(owner->second) + " and " + std::to_string(bus),
          where, "a connection without impedance in substation '" + station.name + "' is not modelled",
          "open a switch or combine the two buses");
  }
}

}  // namespace swingbank::sim::formats::psse
