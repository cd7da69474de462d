#include "sim/formats/detail/network_reader.hpp"

#include <algorithm>
#include <cmath>

namespace swingbank::sim::formats {

using psse::Fields;
using psse::shortest;

bool NetworkReader::status(int value, const char* name, const Fields& fields) {
  if (value != 0 && value != 1)
    problems_.add(std::string(name) + " = " + std::to_string(value), fields.where(), "a status is 0 or 1",
                  "give 1 (in service) or 0 (out of service)");
  return value == 1;
}

void NetworkReader::add_bus(network::Bus b, const Fields& fields) {
  if (b.number <= 0)
    problems_.add("bus number " + std::to_string(b.number), fields.where(), "numbers are positive",
                  "give a positive number");
  if (b.type != network::BusType::isolated && !(b.vm > 0)) {
    network_.remark("bus voltages of 0 pu or below are replaced by 1 pu",
                    "bus " + std::to_string(b.number) + " (" + fields.where() + ")");
    b.vm = 1.0;
  }
  index_.emplace(b.number, static_cast<int>(network_.buses.size()));
  network_.buses.push_back(std::move(b));
}

void NetworkReader::raise_impedance(network::Branch& b, const Fields& fields) {
  if (b.from >= 0 && b.to >= 0)
    network::raise_impedance(network_, b.r, b.x, network_.branch_text(b) + " (" + fields.where() + ")");
}

void NetworkReader::check_ends(const char* what, const network::Branch& b, const Fields& fields) {
  if (b.from == b.to && b.from >= 0)
    problems_.add(std::string(what) + " from bus " + std::to_string(at(b.from).number) + " to itself",
                  fields.where(), "a branch connects two buses", "correct the bus numbers");
}

network::Branch NetworkReader::transformer_of(int from, int to, std::string circuit, bool in_service,
                                              Impedance z) {
  network::Branch b{};
  b.transformer = true;
  b.from = from;
  b.to = to;
  b.circuit = std::move(circuit);
  b.in_service = in_service;
  b.r = static_cast<double>(z.real());
  b.x = static_cast<double>(z.imag());
  return b;
}

std::array<Impedance, 3> NetworkReader::star_equivalent(Impedance z12, Impedance z23, Impedance z31) {
  std::array<Impedance, 3> z{(z12 + z31 - z23) / 2.0L, (z12 + z23 - z31) / 2.0L, (z31 + z23 - z12) / 2.0L};
  // An impedance counts as zero if it is below the rounding error of the three values from which it is
  // computed.
  for (Impedance& winding : z)
    if (std::abs(winding) <= 1e-12L * (std::abs(z12) + std::abs(z23) + std::abs(z31))) winding = {};
  return z;
}

int NetworkReader::add_star_point(const std::array<int, 3>& ends, const std::string& circuit, bool in_service,
                                  double vm, double va) {
  network::Bus star{};
  for (std::size_t i = 0; i < 3; ++i) star.star_of[i] = at(ends[i]).number;
  const auto& [first, second, third] = star.star_of;
  // Star points are numbered above every bus of the file, in the order of the transformers.
  star.number = index_.rbegin()->first + 1 + static_cast<int>(stars_.size());
  star.name = "STAR " + std::to_string(first) + "-" + std::to_string(second) + "-" + std::to_string(third) +
              " " + circuit;
  star.kv = 0.0;  // no nominal voltage: windings of three voltages meet here
  star.type = in_service ? network::BusType::load : network::BusType::isolated;
  star.vm = vm;
  star.va = va;
  const int index = static_cast<int>(network_.buses.size());
  network_.buses.push_back(std::move(star));
  stars_.insert(index);
  return index;
}

std::string NetworkReader::switched_id(int bus, const std::string& id) const {
  std::string free = id == "1" ? "SW" : "SW" + id;
  while (std::ranges::any_of(network_.shunts,
                             [&](const network::Shunt& o) { return o.bus == bus && o.id == free; }))
    free += "+";
  return free;
}

int NetworkReader::regulated_by(int bus, int number, const char* field, const Fields& fields) {
  if (number == 0) return bus;
  if (const auto found = index_.find(std::abs(number)); found != index_.end()) return found->second;
  network_.remark("switched shunts that regulate a missing bus regulate their own",
                  "bus " + std::to_string(at(bus).number) + ": " + field + std::to_string(number) + " (" +
                      fields.where() + ")");
  return bus;
}

void NetworkReader::add_steps(network::SwitchedShunt& shunt, int count, double each, const Fields& fields) {
  constexpr int most = 1000;  // largest permitted number of steps of a block
  if (count < 0 || count > most)
    problems_.add(
        "bus " + std::to_string(at(shunt.bus).number) + ": a block of " + std::to_string(count) + " steps",
        fields.where(), "0 to 1000 are allowed", "correct the number");
  const auto [inductive, capacitive] = std::ranges::minmax(shunt.steps);
  double sum = each > 0.0 ? capacitive : inductive;
  for (int i = 0; i < std::min(count, most) && each != 0.0; ++i) shunt.steps.push_back(sum += each);
}

void NetworkReader::check_machine(network::Generator& g, const MachineNames& names, const std::string& place,
                                  const Fields& fields) {
  if (!(g.mva > 0)) {
    const std::string given = std::string(names.mva) + " = " + shortest(g.mva) + " MVA";
    if (units_only_)
      problems_.add(given, fields.where(), "the machine's per-unit values refer to it",
                    "give a base > 0 MVA");
    else if (g.in_service)
      network_.remark("machine bases of 0 MVA or below are replaced by " + std::string(names.base),
                      place + ": " + given);
    if (!units_only_) g.mva = static_cast<double>(base_);
  }
  const std::string r = names.r, x = names.x;
  if (g.in_service && (g.rt != 0.0 || g.xt != 0.0) && !(g.rt >= 0 && g.xt >= 0))
    problems_.add(r + " = " + shortest(g.rt) + " pu, " + x + " = " + shortest(g.xt) + " pu", fields.where(),
                  "resistance and leakage reactance cannot be negative",
                  "give " + r + " >= 0 and " + x + " >= 0");
}

void NetworkReader::regulate_own_bus(network::Generator& g, const char* what, const std::string& where) {
  g.regulated = -1;
  g.vset = at(g.bus).vm;
  network_.remark(what, "'" + g.id + "' at bus " + std::to_string(at(g.bus).number) + " (" + where + ")");
}

void NetworkReader::check_network() {
  network::settle_isolated(network_);
  network::isolate_idle_stars(network_, stars_);
  network::check_finite(network_, file_, problems_);
}

void NetworkReader::complete_network(const std::function<std::string(std::size_t)>& place) {
  if (!problems_.empty()) return;
  if (!devices_.empty() || !identities_.kept().empty()) network::settle_stars(network_, stars_);
  network::settle_duplicates(network_, identities_.kept(), options_.repeated == Repeated::voltages, devices_);
  network::replace_devices(network_, devices_, options_.devices, problems_);
  network::settle_generators(network_, place);
  network::settle_islands(network_);
}

}  // namespace swingbank::sim::formats
