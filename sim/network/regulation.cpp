// Voltage regulation by generators, and reactive limits.
#include "sim/network/detail/regulation.hpp"

#include <algorithm>
#include <map>

#include "sim/network/detail/index.hpp"

namespace swingbank::sim::network {

Regulation::Regulation(const Network& network)
    : n_(network), base_(network.buses.size()), supply_(network.buses.size()) {
  for (std::size_t i = 0; i < n_.buses.size(); ++i) {
    if (n_.buses[i].type == BusType::isolated) base_[i].kind = Role::out;
    if (n_.buses[i].type == BusType::slack) base_[i].kind = Role::slack;
  }
  std::map<int, std::size_t> source_of;
  for (const Generator& g : n_.generators) {
    if (!g.in_service) continue;
    supply_[as_index(g.bus)] += g.mva;
    base_[as_index(g.bus)].generation += Complex(g.p, 0.0);
    if (n_.buses[as_index(g.bus)].type == BusType::load) {
      base_[as_index(g.bus)].generation += Complex(0.0, g.q);
      continue;
    }
    const bool remote =
        g.regulated >= 0 && g.regulated != g.bus && base_[as_index(g.regulated)].kind != Role::out;
    if (base_[as_index(g.bus)].kind == Role::slack)
      base_[as_index(g.bus)].setpoint = remote ? n_.buses[as_index(g.bus)].vm : g.vset;
    const auto [found, fresh] = source_of.emplace(g.bus, sources_.size());
    if (fresh) sources_.push_back({g.bus, remote ? g.regulated : g.bus, g.vset});
    Source& source = sources_[found->second];
    source.setpoint = g.vset;
    source.share += g.share;
    source.q_min += g.q_min;
    source.q_max += g.q_max;
  }
  for (Source& source : sources_) {
    source.bounded = source.q_min <= source.q_max && base_[as_index(source.bus)].kind != Role::slack;
    if (!(source.share > 0.0)) source.share = supply_[as_index(source.bus)];
  }
  assign();
}

void Regulation::assign() {
  roles_ = base_;
  std::map<int, std::vector<const Source*>> remote_sources;
  for (const Source& s : sources_) {
    Role& role = roles_[as_index(s.bus)];
    if (role.kind == Role::slack) continue;
    role.share = s.share;
    role.setpoint = s.setpoint;
    if (s.side != 0)
      role.generation += Complex(0.0, s.side > 0 ? s.q_max : s.q_min);
    else if (s.target == s.bus)
      role.kind = Role::regulated;
    else
      remote_sources[s.target].push_back(&s);
  }
  for (const auto& [target, sources] : remote_sources) {
    const Role::Kind kind = roles_[as_index(target)].kind;
    const bool itself = kind == Role::slack || kind == Role::regulated;
    if (kind == Role::slack && !(roles_[as_index(target)].share > 0.0)) roles_[as_index(target)].share = 1.0;
    const int leader = itself ? target : sources.front()->bus;
    for (const Source* s : sources) {
      Role& role = roles_[as_index(s->bus)];
      role.target = target;
      role.leader = leader;
      role.kind = s->bus == leader ? Role::leads : Role::follows;
    }
  }
  double most = 0.0;  // scales the largest share to 1, so that all equations have similar magnitudes
  for (const Role& role : roles_) most = std::max(most, role.share);
  for (Role& role : roles_) role.share /= most;
}

bool Regulation::limit(const std::function<double(int)>& reactive,
                       const std::function<double(int)>& voltage) {
  constexpr double beyond = 1e-9;  // tolerance [pu] for rounding
  constexpr int most = 3;          // largest number of returns; afterwards the bus stays at its limit
  bool moved = false;
  for (Source& s : sources_) {
    if (!s.bounded) continue;
    if (s.side == 0) {
      const double q = reactive(s.bus);
      s.side = q > s.q_max + beyond ? 1 : q < s.q_min - beyond ? -1 : 0;
      moved = moved || s.side != 0;
    } else if (s.returns < most && s.q_max > s.q_min && s.side * (voltage(s.target) - s.setpoint) > beyond) {
      s.side = 0;
      ++s.returns;
      moved = true;
    }
  }
  if (moved) assign();
  return moved;
}

std::vector<int> Regulation::at_limit() const {
  std::vector<int> list;
  for (const Source& s : sources_)
    if (s.side != 0) list.push_back(s.bus);
  std::ranges::sort(list);
  return list;
}

}  // namespace swingbank::sim::network
