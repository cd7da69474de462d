#include "sim/grid/detail/step_up.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <string>

namespace swingbank::sim::grid {
namespace {

constexpr double kSameRatio = 1e-6;  ///< tolerance of equal ratios: circulating current 1e-5 pu at X = 0.1 pu

/// Returns the buses of the shortest path through transformers from `machine` to `far`; empty if there is
/// none.
std::vector<int> way_of_buses(const network::Network& n, int machine, int far) {
  std::vector<int> before(n.buses.size(), -1);
  before[static_cast<std::size_t>(machine)] = machine;
  std::deque<int> next{machine};
  while (!next.empty() && before[static_cast<std::size_t>(far)] < 0) {
    const int bus = next.front();
    next.pop_front();
    for (const network::Branch& b : n.branches) {
      if (!b.transformer || !b.in_service || (b.from != bus && b.to != bus)) continue;
      const int other = b.from == bus ? b.to : b.from;
      int& of = before[static_cast<std::size_t>(other)];
      if (of >= 0) continue;
      of = bus;
      next.push_back(other);
    }
  }
  std::vector<int> way;
  if (machine == far || before[static_cast<std::size_t>(far)] < 0) return way;
  for (int bus = far; bus != machine; bus = before[static_cast<std::size_t>(bus)]) way.push_back(bus);
  way.push_back(machine);
  std::ranges::reverse(way);
  return way;
}

bool on_the_way(const StepUp& way, std::size_t branch) {
  return std::ranges::any_of(way.stages,
                             [&](const auto& stage) { return std::ranges::count(stage, branch) > 0; });
}

/// Returns a description of equipment at a bus other than branches, or "".
std::string equipment_at(const network::Network& n, int bus) {
  for (const network::Generator& g : n.generators)
    if (g.bus == bus && g.in_service) return "generator '" + g.id + "'";
  for (const network::Load& l : n.loads)
    if (l.bus == bus) return "load '" + l.id + "'";
  for (const network::Shunt& s : n.shunts)
    if (s.bus == bus && s.admittance != Complex{}) return "shunt '" + s.id + "'";
  return "";
}

}  // namespace

StepUp step_up(const network::Network& n, int machine, int far, const StepUp& first) {
  StepUp out = first;
  out.buses = way_of_buses(n, machine, far);
  for (std::size_t k = 0; k + 1 < out.buses.size(); ++k) {
    const int near = out.buses[k], next = out.buses[k + 1];
    std::vector<std::size_t> stage;
    Complex admittance{};
    double ratio = 1.0;
    for (std::size_t i = 0; i < n.branches.size(); ++i) {
      const network::Branch& b = n.branches[i];
      const bool ahead = b.from == near && b.to == next;
      if (!b.transformer || !b.in_service || !(ahead || (b.from == next && b.to == near))) continue;
      // A branch is an ideal ratio tap:1 at its `from` side in series with the impedance.
      const double own = ahead ? 1.0 / b.tap : b.tap;
      const Complex z = Complex(b.r, b.x) * (ahead ? b.tap * b.tap : 1.0);
      if (stage.empty()) ratio = own;
      out.same_ratio = out.same_ratio && std::abs(own - ratio) <= kSameRatio;
      out.magnetising = out.magnetising || b.shunt_from != Complex{};
      admittance += 1.0 / z;
      stage.push_back(i);
    }
    out.z += 1.0 / admittance / (out.ratio * out.ratio);
    out.ratio *= ratio;
    out.stages.push_back(std::move(stage));
  }
  return out;
}

std::string joins_on_the_way(const network::Network& n, const StepUp& way, int bus) {
  if (std::string here = equipment_at(n, bus); !here.empty()) return here + " at " + n.bus_text(bus);
  for (std::size_t i = 0; i < n.branches.size(); ++i) {
    const network::Branch& b = n.branches[i];
    if (!b.in_service || (b.from != bus && b.to != bus) || on_the_way(way, i)) continue;
    const int other = b.from == bus ? b.to : b.from;
    const bool ends_there =
        equipment_at(n, other).empty() && std::ranges::none_of(n.branches, [&](const network::Branch& o) {
          return &o != &b && o.in_service && (o.from == other || o.to == other);
        });
    if (!ends_there)
      return (n.buses[static_cast<std::size_t>(b.to)].is_star() ? "the " : "branch ") + n.branch_text(b);
  }
  return "";
}

}  // namespace swingbank::sim::grid
