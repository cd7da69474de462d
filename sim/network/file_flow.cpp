// The file's voltages as power-flow solution, and their imbalances.
#include <fmt/format.h>

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "sim/network/admittance.hpp"
#include "sim/network/detail/index.hpp"
#include "sim/network/powerflow.hpp"
#include "sim/network/tie.hpp"

namespace swingbank::sim::network {
namespace {

std::vector<Complex> voltages_of_file(const Network& network) {
  std::vector<Complex> v;
  for (const Bus& b : network.buses)
    v.push_back(b.type == BusType::isolated ? Complex{} : std::polar(b.vm, b.va));
  return v;
}

/// Computes the imbalances of imbalance_of_file() at the voltages `voltage` [pu].
std::vector<Complex> imbalance_at(const Network& network, const std::vector<Complex>& voltage, TiesIn ties) {
  const Eigen::Map<const Eigen::VectorXcd> v(voltage.data(), static_cast<Eigen::Index>(voltage.size()));
  const Eigen::VectorXcd s = v.cwiseProduct((bus_admittance(network, {}, ties) * v).conjugate());
  std::vector<Complex> left(s.begin(), s.end());
  for (const Load& l : network.loads) {
    const double vm = std::abs(v[l.bus]);
    left[as_index(l.bus)] += l.power + vm * (l.current + vm * l.admittance);
  }
  for (const Generator& g : network.generators)
    if (g.in_service) left[as_index(g.bus)] -= Complex(g.p, g.q);
  return left;
}

}  // namespace

std::vector<Complex> imbalance_of_file(const Network& network) {
  return imbalance_at(network, voltages_of_file(network), TiesIn::matrix);
}

namespace {

/// Voltages and the power mismatch of every bus. A file's voltages have too few digits for the current of a
/// tie. Among buses joined by ties, only one keeps the file's voltage, preferably a bus with a generator. The
/// voltages of the other joined buses are computed from this voltage, and their mismatches are moved to this
/// bus.
struct FileSolution {
  std::vector<Complex> voltage, left;
};
FileSolution solution_of_file(const Network& network) {
  FileSolution out;
  out.voltage = voltages_of_file(network);
  const std::vector<Tie> all = ties(network);
  std::vector<std::vector<std::size_t>> at_bus(network.buses.size());
  for (std::size_t k = 0; k < all.size(); ++k)
    for (const int end : {all[k].from, all[k].to}) at_bus[as_index(end)].push_back(k);
  struct Step {
    int bus, other;  ///< `bus` is nearer to the first bus
    std::size_t tie;
  };
  std::vector<Step> tree;
  std::vector<char> known(network.buses.size(), 0);
  std::vector<std::size_t> firsts(network.buses.size());
  std::iota(firsts.begin(), firsts.end(), 0);
  // A generator balances the mismatch that arrives at its bus.
  std::stable_partition(firsts.begin(), firsts.end(), [&](std::size_t bus) {
    return std::ranges::any_of(network.generators,
                               [&](const Generator& g) { return g.in_service && as_index(g.bus) == bus; });
  });
  for (const std::size_t first : firsts) {
    if (at_bus[first].empty() || std::exchange(known[first], 1)) continue;
    std::vector<int> way{static_cast<int>(first)};
    for (std::size_t k = 0; k < way.size(); ++k)
      for (const std::size_t t : at_bus[as_index(way[k])]) {
        const int other = all[t].from == way[k] ? all[t].to : all[t].from;
        if (std::exchange(known[as_index(other)], 1)) continue;
        out.voltage[as_index(other)] = all[t].to == other ? out.voltage[as_index(way[k])] / all[t].ratio
                                                          : out.voltage[as_index(way[k])] * all[t].ratio;
        way.push_back(other);
        tree.push_back({way[k], other, t});
      }
  }
  out.left = imbalance_at(network, out.voltage, TiesIn::equations);
  for (auto step = tree.rbegin(); step != tree.rend(); ++step)
    out.left[as_index(step->bus)] += std::exchange(out.left[as_index(step->other)], Complex{});
  return out;
}

}  // namespace

PowerFlow flow_of_file(Network& network) {
  auto [voltage, left] = solution_of_file(network);
  PowerFlow flow;
  flow.voltage = std::move(voltage);
  std::vector<double> mva(network.buses.size());
  for (const Generator& g : network.generators)
    if (g.in_service) mva[as_index(g.bus)] += g.mva;
  for (const Generator& g : network.generators)
    flow.generation.push_back(g.in_service
                                  ? Complex(g.p, g.q) + left[as_index(g.bus)] * (g.mva / mva[as_index(g.bus)])
                                  : Complex{});
  std::vector<std::pair<double, std::size_t>> sizes;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (network.buses[i].type == BusType::isolated || mva[i] > 0.0 || left[i] == Complex{}) continue;
    const Complex admittance = -left[i] / std::norm(flow.voltage[i]);
    network.loads.push_back({static_cast<int>(i), "~", {}, {}, admittance, 1, 1, 1, LoadKind::device});
    sizes.emplace_back(std::abs(left[i]) * network.base_mva, i);
  }
  std::ranges::sort(sizes, std::greater{});
  for (const auto& [size, i] : sizes)
    network.remark("imbalances of the file's voltages are balanced by constant admittances, largest first",
                   network.bus_text(static_cast<int>(i)) + fmt::format(": {:.2f} MVA", size));
  return flow;
}

}  // namespace swingbank::sim::network
