#include "sim/network/admittance.hpp"

#include <Eigen/SparseLU>
#include <algorithm>
#include <utility>

#include "base/problem.hpp"
#include "sim/network/connectivity.hpp"
#include "sim/network/tie.hpp"

namespace swingbank::sim::network {
namespace {

using Entries = std::vector<Eigen::Triplet<Complex>>;

/// A tie in TiesIn::equations contributes only its charging and line shunts.
void add_branch(const Branch& b, TiesIn ties, Entries& entries) {
  if (ties == TiesIn::equations && is_tie(b)) {
    const Complex half(0.0, 0.5 * b.b);
    entries.emplace_back(b.from, b.from, half / (b.tap * b.tap) + b.shunt_from);
    entries.emplace_back(b.to, b.to, half + b.shunt_to);
    return;
  }
  const BranchEnd from = branch_end(b, true), to = branch_end(b, false);
  entries.emplace_back(b.from, b.from, from.own);
  entries.emplace_back(b.from, b.to, from.other);
  entries.emplace_back(b.to, b.from, to.other);
  entries.emplace_back(b.to, b.to, to.own);
}

Entries branches_and_shunts(const Network& network, const Topology& topology, TiesIn ties) {
  Entries entries;
  for (std::size_t i = 0; i < network.branches.size(); ++i)
    if (network.branches[i].in_service && !std::ranges::binary_search(topology.open, static_cast<int>(i)))
      add_branch(network.branches[i], ties, entries);
  for (const Shunt& s : network.shunts) entries.emplace_back(s.bus, s.bus, s.admittance);
  return entries;
}

Eigen::SparseMatrix<Complex> matrix(const Network& network, const Entries& entries) {
  const auto n = static_cast<Eigen::Index>(network.buses.size());
  Eigen::SparseMatrix<Complex> y(n, n);
  y.setFromTriplets(entries.begin(), entries.end());
  return y;
}

/// Throws if the network has no voltage source, or an island has none although nothing is tripped.
void check_supplied(const Network& network, const Topology& topology, const std::vector<int>& dead) {
  if (dead.empty()) return;
  const bool tripped = !topology.open.empty() || !topology.tripped.empty();
  const auto live =
      std::ranges::count_if(network.buses, [](const Bus& b) { return b.type != BusType::isolated; });
  if (tripped && static_cast<std::ptrdiff_t>(dead.size()) < live) return;
  throw InputError(
      {bus_list(network, dead) + (dead.size() == 1 ? " is" : " are") + " islanded", network.origin,
       tripped ? "the trips leave no generator in service"
               : "no path through branches in service leads to a generator",
       tripped ? "trip fewer generators or branches" : "close a branch, or remove the islanded buses"});
}

}  // namespace

std::vector<int> dead_buses(const Network& network, const Topology& topology) {
  const auto island = islands(network, topology.open);
  std::vector<char> supplied(network.buses.size(), 0);  // by island; there are no more islands than buses
  for (std::size_t k = 0; k < network.generators.size(); ++k) {
    const Generator& g = network.generators[k];
    const int at = island[static_cast<std::size_t>(g.bus)];
    if (g.in_service && at >= 0 && !std::ranges::binary_search(topology.tripped, static_cast<int>(k)))
      supplied[static_cast<std::size_t>(at)] = 1;
  }
  std::vector<int> dead;
  for (std::size_t i = 0; i < island.size(); ++i)
    if (island[i] >= 0 && !supplied[static_cast<std::size_t>(island[i])]) dead.push_back(static_cast<int>(i));
  return dead;
}

BranchEnd branch_end(const Branch& b, bool at_from) {
  const Complex y = 1.0 / Complex(b.r, b.x), half(0.0, 0.5 * b.b), n = std::polar(b.tap, b.shift);
  if (at_from) return {(y + half) / (b.tap * b.tap) + b.shunt_from, -y / std::conj(n)};
  return {y + half + b.shunt_to, -y / n};
}

Complex consumption(const Load& load, const PowerFlow& flow) {
  const double vm = std::abs(flow.voltage[static_cast<std::size_t>(load.bus)]);
  return load.power + load.current * vm + load.admittance * (vm * vm);
}

Eigen::SparseMatrix<Complex> bus_admittance(const Network& network, const Topology& topology, TiesIn ties) {
  return matrix(network, branches_and_shunts(network, topology, ties));
}

Eigen::SparseMatrix<Complex> dynamic_admittance(const Network& network, const PowerFlow& flow,
                                                const Topology& topology, const std::vector<int>& without,
                                                TiesIn ties) {
  const std::vector<int> dead = dead_buses(network, topology);
  check_supplied(network, topology, dead);
  Entries entries = branches_and_shunts(network, topology, ties);
  const auto squared = [&](int bus) { return std::norm(flow.voltage[static_cast<std::size_t>(bus)]); };
  for (std::size_t i = 0; i < network.loads.size(); ++i) {
    if (std::ranges::binary_search(without, static_cast<int>(i))) continue;
    const Load& l = network.loads[i];
    entries.emplace_back(l.bus, l.bus, std::conj(consumption(l, flow)) / squared(l.bus));
  }
  for (const auto& [bus, power] : topology.load_steps)
    entries.emplace_back(bus, bus, std::conj(power) / squared(bus));
  for (const auto& [bus, z] : topology.faults)
    if (z != Complex{}) entries.emplace_back(bus, bus, 1.0 / z);
  for (std::size_t i = 0; i < network.buses.size(); ++i)
    if (network.buses[i].type == BusType::isolated)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 1.0);
  for (const int bus : dead) entries.emplace_back(bus, bus, 1.0);  // V = 0 at dead buses
  return matrix(network, entries);
}

std::vector<int> grounded_buses(const Network& network, const Topology& topology) {
  std::vector<int> buses = dead_buses(network, topology);
  for (const auto& [bus, z] : topology.faults)
    if (z == Complex{}) buses.push_back(bus);
  std::ranges::sort(buses);
  buses.erase(std::unique(buses.begin(), buses.end()), buses.end());
  return buses;
}

ReducedNetwork reduce(const Network& network, const PowerFlow& flow, const Topology& topology,
                      const std::vector<int>& kept, const std::vector<int>& without) {
  const auto full = dynamic_admittance(network, flow, topology, without);
  const auto grounded = grounded_buses(network, topology);
  const auto n = static_cast<int>(network.buses.size());
  std::vector<int> keep(static_cast<std::size_t>(n), -1),
      rest(static_cast<std::size_t>(n), -1);  // positions in the reduced system
  for (std::size_t k = 0; k < kept.size(); ++k) keep[static_cast<std::size_t>(kept[k])] = static_cast<int>(k);
  ReducedNetwork reduced;
  for (const int bus : grounded)
    if (int& k = keep[static_cast<std::size_t>(bus)]; k >= 0)
      reduced.grounded.push_back(std::exchange(k, -1));
  std::ranges::sort(reduced.grounded);
  int others = 0;
  for (int i = 0; i < n; ++i)
    if (keep[static_cast<std::size_t>(i)] < 0 && !std::ranges::count(grounded, i) &&
        !std::ranges::count(kept, i))
      rest[static_cast<std::size_t>(i)] = others++;

  const auto size = static_cast<Eigen::Index>(kept.size());
  reduced.y = Eigen::MatrixXcd::Zero(size, size);
  Eigen::MatrixXcd ke = Eigen::MatrixXcd::Zero(size, others), ek = Eigen::MatrixXcd::Zero(others, size);
  Entries inner;
  for (int j = 0; j < full.outerSize(); ++j)
    for (Eigen::SparseMatrix<Complex>::InnerIterator e(full, j); e; ++e) {
      const auto i = static_cast<std::size_t>(e.row()), c = static_cast<std::size_t>(j);
      if (keep[i] >= 0 && keep[c] >= 0) reduced.y(keep[i], keep[c]) = e.value();
      if (keep[i] >= 0 && rest[c] >= 0) ke(keep[i], rest[c]) = e.value();
      if (rest[i] >= 0 && keep[c] >= 0) ek(rest[i], keep[c]) = e.value();
      if (rest[i] >= 0 && rest[c] >= 0) inner.emplace_back(rest[i], rest[c], e.value());
    }
  if (others == 0) return reduced;
  Eigen::SparseMatrix<Complex> ee(others, others);
  ee.setFromTriplets(inner.begin(), inner.end());
  Eigen::SparseLU<Eigen::SparseMatrix<Complex>> lu(ee);
  if (lu.info() != Eigen::Success)
    throw InputError({"the admittance matrix is singular", network.origin,
                      "series and shunt elements cancel at some bus", "check impedances and shunts"});
  reduced.y -= ke * lu.solve(ek);
  return reduced;
}

}  // namespace swingbank::sim::network
