#include "sim/batch/detail/switched_network.hpp"

#include <algorithm>

#include "sim/network/admittance.hpp"

namespace swingbank::sim::batch {

namespace {
/// Smallest accepted reciprocal condition number of the system of affected buses. Below it, the products lose
/// more than three digits.
constexpr double kLeastCondition = 1e-3;
}  // namespace

SwitchedNetwork::SwitchedNetwork(const grid::Grid& grid, const std::vector<double>& r,
                                 const std::vector<double>& x)
    : grid_(grid), own_(network::dynamic_admittance(grid.network, grid.flow, {})) {
  closed_ = own_;
  for (std::size_t i = 0; i < grid.plants.size(); ++i) {
    const plant::Plant& plant = grid.plants[i];
    const Complex own = 1.0 / Complex(r[i], x[i]);
    plants_.push_back({plant.bus, own * (plant.mva / grid.network.base_mva), own});
    closed_.coeffRef(plant.bus, plant.bus) += plants_[i].source;
  }
  closed_.makeCompressed();
  factors_.compute(closed_);
  transposed_.compute(Sparse(closed_.transpose()));
  sound_ = factors_.info() == Eigen::Success && transposed_.info() == Eigen::Success;
}

Eigen::MatrixXcd SwitchedNetwork::unit_currents(const std::vector<int>& buses) const {
  const auto count = static_cast<Eigen::Index>(buses.size());
  Eigen::MatrixXcd at = Eigen::MatrixXcd::Zero(own_.rows(), count);
  for (Eigen::Index k = 0; k < count; ++k) at(buses[static_cast<std::size_t>(k)], k) = 1.0;
  return at;
}

Eigen::VectorXcd SwitchedNetwork::row(int plant) const {
  const auto k = static_cast<std::size_t>(plant);
  const Eigen::VectorXcd voltage = transposed_.solve(Eigen::VectorXcd(unit_currents({plants_[k].bus})));
  Eigen::VectorXcd out(static_cast<Eigen::Index>(plants_.size()));
  for (std::size_t j = 0; j < plants_.size(); ++j)
    out[static_cast<Eigen::Index>(j)] =
        plants_[k].own * ((j == k ? 1.0 : 0.0) - voltage[plants_[j].bus] * plants_[j].source);
  return out;
}

Eigen::VectorXcd SwitchedNetwork::column(int plant) const {
  const auto j = static_cast<std::size_t>(plant);
  const Eigen::VectorXcd voltage = factors_.solve(Eigen::VectorXcd(unit_currents({plants_[j].bus})));
  Eigen::VectorXcd out(static_cast<Eigen::Index>(plants_.size()));
  for (std::size_t k = 0; k < plants_.size(); ++k)
    out[static_cast<Eigen::Index>(k)] =
        plants_[k].own * ((j == k ? 1.0 : 0.0) - voltage[plants_[k].bus] * plants_[j].source);
  return out;
}

std::optional<SwitchedNetwork::Touched> SwitchedNetwork::touch(const network::Topology& topology,
                                                               int most) const {
  const Sparse added = network::dynamic_admittance(grid_.network, grid_.flow, topology) - own_;
  Touched touched;
  touched.buses = network::grounded_buses(grid_.network, topology);
  const auto each = [&](const auto& what) {
    for (int j = 0; j < added.outerSize(); ++j)
      for (Sparse::InnerIterator e(added, j); e; ++e)
        if (e.value() != Complex{}) what(static_cast<int>(e.row()), j, e.value());
  };
  each([&](int row, int column, Complex) {
    touched.buses.push_back(row);
    touched.buses.push_back(column);
  });
  auto& buses = touched.buses;
  std::ranges::sort(buses);
  buses.erase(std::unique(buses.begin(), buses.end()), buses.end());
  if (static_cast<int>(buses.size()) > most) return {};
  const auto count = static_cast<Eigen::Index>(buses.size());
  const auto place = [&](int bus) { return std::ranges::lower_bound(buses, bus) - buses.begin(); };
  touched.admittance = Eigen::MatrixXcd::Zero(count, count);
  each([&](int row, int column, Complex value) { touched.admittance(place(row), place(column)) = value; });
  touched.voltage = factors_.solve(unit_currents(buses));
  return touched;
}

/// Returns the currents J into the affected buses, per unit of their voltages V without the switching. They
/// satisfy J = -Y (V + Z J), and V + Z J = 0 at buses with a bolted fault. Returns none if the system is
/// ill-conditioned.
std::optional<Eigen::MatrixXcd> SwitchedNetwork::currents(const Touched& touched,
                                                          const std::vector<int>& bolted) const {
  const auto count = touched.admittance.rows();
  const Eigen::MatrixXcd z = touched.voltage(touched.buses, Eigen::all);
  Eigen::MatrixXcd a = Eigen::MatrixXcd::Identity(count, count) + touched.admittance * z;
  Eigen::MatrixXcd b = -touched.admittance;
  for (Eigen::Index k = 0; k < count; ++k)
    if (std::ranges::count(bolted, touched.buses[static_cast<std::size_t>(k)])) {
      a.row(k) = z.row(k) / z(k, k);
      b.row(k).setZero();
      b(k, k) = -1.0 / z(k, k);
    }
  const Eigen::PartialPivLU<Eigen::MatrixXcd> lu(a);
  if (!(lu.rcond() > kLeastCondition)) return {};
  return lu.solve(b);
}

std::optional<LowRank> SwitchedNetwork::change(const network::Topology& topology, int most) const {
  LowRank out;
  if (topology == network::Topology{}) return out;
  if (!sound_ || !topology.tripped.empty() || !topology.partly_tripped.empty()) return {};
  const auto touched = touch(topology, most);
  if (!touched) return {};
  if (touched->buses.empty()) return out;
  const auto into = currents(*touched, network::grounded_buses(grid_.network, topology));
  if (!into) return {};
  const Eigen::MatrixXcd v = touched->voltage * *into;
  const Eigen::MatrixXcd before = transposed_.solve(unit_currents(touched->buses));
  out.rank = static_cast<int>(v.cols());
  for (Eigen::Index k = 0; k < v.cols(); ++k)
    for (const Feed& plant : plants_)
      out.add(-plant.own * v(plant.bus, k), before(plant.bus, k) * plant.source);
  return out;
}

}  // namespace swingbank::sim::batch
