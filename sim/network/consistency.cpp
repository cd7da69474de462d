#include "sim/network/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace swingbank::sim::network {
namespace {

const Bus& at(const Network& n, int bus) { return n.buses[static_cast<std::size_t>(bus)]; }
std::string pu(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

}  // namespace

void settle_isolated(Network& n) {
  const auto isolated = [&](int bus) { return at(n, bus).type == BusType::isolated; };
  std::erase_if(n.loads, [&](const Load& l) { return isolated(l.bus); });
  std::erase_if(n.shunts, [&](const Shunt& s) { return isolated(s.bus); });
  for (Branch& b : n.branches)
    if (isolated(b.from) || isolated(b.to)) b.in_service = false;
  for (Generator& g : n.generators)
    if (isolated(g.bus)) g.in_service = false;
}

void check_held_voltages(const Network& n, const std::function<std::string(std::size_t)>& where,
                         Problems& problems) {
  std::map<int, double> held;
  for (std::size_t i = 0; i < n.generators.size(); ++i) {
    const Generator& g = n.generators[i];
    if (!g.in_service) continue;
    const Bus& b = at(n, g.bus);
    if (b.type == BusType::load)
      problems.add("a generator in service at bus " + std::to_string(b.number) + " of type 1", where(i),
                   "a load bus holds no voltage, so the generator would be ignored",
                   "make the bus type 2 or take the generator out of service");
    const auto [other, first] = held.emplace(g.bus, g.vset);
    if (!first && other->second != g.vset)
      problems.add(
          "VS = " + pu(g.vset) + " pu", where(i),
          "another generator at bus " + std::to_string(b.number) + " holds " + pu(other->second) + " pu",
          "give both the same voltage");
  }
}

void check_finite(const Network& n, const std::string& file, Problems& problems) {
  const auto report = [&](const std::string& what, int bus, std::initializer_list<double> values) {
    if (std::ranges::all_of(values, [](double v) { return std::isfinite(v); })) return;
    problems.add(what + " at bus " + std::to_string(n.buses[static_cast<std::size_t>(bus)].number) +
                     " is beyond the range of numbers",
                 file, "a value or a base it is divided by is absurdly large or small",
                 "correct the value or the base");
  };
  for (const Load& l : n.loads)
    report("load '" + l.id + "'", l.bus,
           {l.power.real(), l.power.imag(), l.current.real(), l.current.imag(), l.admittance.real(),
            l.admittance.imag()});
  for (const Shunt& s : n.shunts)
    report("shunt '" + s.id + "'", s.bus, {s.admittance.real(), s.admittance.imag()});
  for (const Branch& b : n.branches)
    report("the branch with circuit '" + b.circuit + "'", b.from,
           {b.r, b.x, b.b, b.tap, b.shift, b.shunt_from.real(), b.shunt_from.imag(), b.shunt_to.real(),
            b.shunt_to.imag()});
  for (const Generator& g : n.generators)
    report("generator '" + g.id + "'", g.bus, {g.p, g.q, g.vset, g.mva, g.zr, g.zx, g.q_min, g.q_max});
}

}  // namespace swingbank::sim::network
