#include "sim/solve/reference_system.hpp"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/network/admittance.hpp"
#include "sim/network/connectivity.hpp"

namespace swingbank::sim {
namespace {

/// Adds the current a machine sends into the network to its signals; T is double or a dual.
template <class T>
void terminal(const T& er, const T& ei, const Complex& y, Signals<T>& s) {
  const T dr = er - s.Vr, di = ei - s.Vi;
  s.Ir = T(y.real()) * dr - T(y.imag()) * di;
  s.Ii = T(y.imag()) * dr + T(y.real()) * di;
}

int delta_state(const Effect& machine) {
  for (std::size_t i = 0; i < machine.states.size(); ++i)
    if (machine.states[i].name == "delta") return static_cast<int>(i);
  return -1;
}

/// Buses that no machine and no fault can hold to a voltage: their equations have no solution.
std::vector<int> cut_off(const Grid& grid, const Topology& topology) {
  const std::vector<int> island = islands(grid.network, topology.open);
  std::vector<bool> held(island.size() + 1, false);
  for (const Plant& plant : grid.plants) held[island[plant.bus] + 1] = true;
  for (const auto& [bus, z] : topology.faults) held[island[bus] + 1] = true;
  held[0] = true;  // isolated buses (-1) are out of the grid
  std::vector<int> lost;
  for (int b = 0; b < static_cast<int>(island.size()); ++b)
    if (!held[island[b] + 1]) lost.push_back(b);
  return lost;
}

}  // namespace

ReferencePlants::ReferencePlants(const Grid& grid) {
  units_.reserve(grid.plants.size());
  for (const Plant& plant : grid.plants) {
    Operating op =
        operating_point(plant, grid.flow.voltage[plant.bus], grid.network.base_mva, grid.conventions);
    const Complex y = 1.0 / Complex(op.r, op.xs);
    units_.push_back({&plant, std::move(op), PlantEquations<double>(plant), PlantEquations<D8>(plant),
                      states_, delta_state(*plant.machine.effect), y, plant.mva / grid.network.base_mva});
    states_ += units_.back().equations.states();
  }
}

Complex ReferencePlants::emf(const Unit& unit, const double* y) const {
  std::vector<double> m(unit.equations.scratch());
  double er, ei;
  unit.equations.emf(unit.operating.c.data(), y + unit.first, m.data(), er, ei);
  return {er, ei};
}

Signals<double> ReferencePlants::signals(const Unit& unit, const double* y, Complex v, double* dx) const {
  std::vector<double> m(unit.equations.scratch()), unused(unit.equations.states());
  const double* c = unit.operating.c.data();
  const double* x = y + unit.first;
  double er, ei;
  unit.equations.emf(c, x, m.data(), er, ei);
  Signals<double> s;
  s.Vr = v.real();
  s.Vi = v.imag();
  s.Efd = unit.operating.Efd;
  s.Tm = unit.operating.Tm;
  terminal(er, ei, unit.y, s);
  unit.equations.derivative(c, x, m.data(), s, dx ? dx : unused.data());
  return s;
}

ReferenceSystem::ReferenceSystem(const Grid& grid, const ReferencePlants& plants, const Topology& topology)
    : plants_(plants), buses_(static_cast<int>(grid.network.buses.size())), bolted_(buses_, false) {
  if (const std::vector<int> lost = cut_off(grid, topology); !lost.empty())
    throw InputError({"cut off: " + bus_list(grid.network, lost), grid.network.origin,
                      "no machine and no fault is left in that part of the grid",
                      "keep a branch to it closed, or take it out of the network"});
  build_network(grid, topology);
  build_pattern();
}

void ReferenceSystem::build_network(const Grid& grid, const Topology& topology) {
  for (int b : bolted_buses(topology)) bolted_[b] = true;
  for (int b = 0; b < buses_; ++b)
    if (grid.network.buses[b].type == BusType::isolated) bolted_[b] = true;  // out of the grid: V = 0
  y_ = dynamic_admittance(grid.network, grid.flow, topology);
  y_.prune([&](Eigen::Index row, Eigen::Index, const Complex&) { return !bolted_[row]; });
}

void ReferenceSystem::build_pattern() {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int col, double value) { entries.emplace_back(row, col, value); };
  for (int b = 0; b < buses_; ++b) {
    const int row = bus_row(b);
    if (bolted_[b]) {
      add(row, row, 1.0);
      add(row + 1, row + 1, 1.0);
    }
    for (decltype(y_)::InnerIterator it(y_, b); it; ++it) {
      const int col = bus_row(static_cast<int>(it.col()));
      add(row, col, it.value().real());
      add(row, col + 1, -it.value().imag());
      add(row + 1, col, it.value().imag());
      add(row + 1, col + 1, it.value().real());
    }
  }
  std::vector<std::vector<int>> members;
  for (const auto& unit : plants_.units()) {
    std::vector<int>& index = members.emplace_back(unit.equations.states());
    std::iota(index.begin(), index.end(), unit.first);
    index.push_back(bus_row(unit.plant->bus));
    index.push_back(bus_row(unit.plant->bus) + 1);
    for (int col : index)
      for (int row : index)
        if (row < plants_.states() || !bolted_[unit.plant->bus]) add(row, col, 0.0);
  }
  constant_.resize(size(), size());
  constant_.setFromTriplets(entries.begin(), entries.end());
  constant_.makeCompressed();

  const auto* outer = constant_.outerIndexPtr();
  const auto* inner = constant_.innerIndexPtr();
  places_.assign(members.size(), {});
  for (std::size_t u = 0; u < members.size(); ++u)
    for (int col : members[u])
      for (int row : members[u]) {
        const auto* place = std::lower_bound(inner + outer[col], inner + outer[col + 1], row);
        const bool found = place != inner + outer[col + 1] && *place == row;
        const bool fixed = row >= plants_.states() && bolted_[plants_.units()[u].plant->bus];
        places_[u].push_back(found && !fixed ? static_cast<int>(place - inner) : -1);
      }
}

void ReferenceSystem::solve_voltages(double* y) const {
  std::vector<Eigen::Triplet<Complex>> entries;
  Eigen::VectorXcd injected = Eigen::VectorXcd::Zero(buses_);
  for (int b = 0; b < buses_; ++b) {
    if (bolted_[b]) entries.emplace_back(b, b, 1.0);
    for (decltype(y_)::InnerIterator it(y_, b); it; ++it)
      entries.emplace_back(b, static_cast<int>(it.col()), it.value());
  }
  for (const auto& unit : plants_.units()) {
    const int b = unit.plant->bus;
    if (bolted_[b]) continue;
    entries.emplace_back(b, b, unit.y * unit.scale);
    injected[b] += unit.y * unit.scale * plants_.emf(unit, y);
  }
  Eigen::SparseMatrix<Complex> matrix(buses_, buses_);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<Complex>> lu(matrix);
  Eigen::VectorXcd v = Eigen::VectorXcd::Constant(buses_, std::nan(""));
  if (lu.info() == Eigen::Success) {
    v = lu.solve(injected);
    v += lu.solve(injected - matrix * v)
             .eval();  // one refinement: a fault impedance of 1e-6 pu stretches the scale
  }
  for (int b = 0; b < buses_; ++b) {
    y[bus_row(b)] = bolted_[b] ? 0.0 : v[b].real();
    y[bus_row(b) + 1] = bolted_[b] ? 0.0 : v[b].imag();
  }
}

void ReferenceSystem::derivatives(const double* y, double* yp) const {
  std::fill(yp, yp + size(), 0.0);
  for (const auto& unit : plants_.units()) {
    const double* v = y + bus_row(unit.plant->bus);
    (void)plants_.signals(unit, y, {v[0], v[1]}, yp + unit.first);
  }
}

void ReferenceSystem::residual(const double* y, const double* yp, double* f) const {
  for (int b = 0; b < buses_; ++b) {
    const double* v = y + bus_row(b);
    Complex current = bolted_[b] ? Complex(v[0], v[1]) : Complex();
    for (decltype(y_)::InnerIterator it(y_, b); it; ++it) {
      const double* w = y + bus_row(static_cast<int>(it.col()));
      current += it.value() * Complex(w[0], w[1]);
    }
    f[bus_row(b)] = current.real();
    f[bus_row(b) + 1] = current.imag();
  }
  for (const auto& unit : plants_.units()) {
    const int b = unit.plant->bus, row = bus_row(b);
    double* dx = f + unit.first;
    const Signals<double> s = plants_.signals(unit, y, {y[row], y[row + 1]}, dx);
    for (int i = 0; i < unit.equations.states(); ++i) dx[i] = yp[unit.first + i] - dx[i];
    if (bolted_[b]) continue;
    f[row] -= s.Ir * unit.scale;
    f[row + 1] -= s.Ii * unit.scale;
  }
}

void ReferenceSystem::jacobian(double a, const double* y, double* values) const {
  std::copy(constant_.valuePtr(), constant_.valuePtr() + constant_.nonZeros(), values);
  for (std::size_t u = 0; u < plants_.units().size(); ++u) plant_jacobian(u, a, y, values);
}

void ReferenceSystem::plant_jacobian(std::size_t u, double a, const double* y, double* values) const {
  const auto& unit = plants_.units()[u];
  const int n = unit.equations.states(), members = n + 2, row = bus_row(unit.plant->bus);
  const std::vector<D8> c(unit.operating.c.begin(), unit.operating.c.end());
  std::vector<D8> x(members), m(unit.equations.scratch()), dx(n);
  for (int from = 0; from < members; from += kDirections) {
    for (int i = 0; i < members; ++i) x[i] = D8(i < n ? y[unit.first + i] : y[row + i - n]);
    const int to = std::min(from + kDirections, members);
    for (int i = from; i < to; ++i) x[i].d[i - from] = 1.0;
    Signals<D8> s;
    D8 er, ei;
    unit.sensitivities.emf(c.data(), x.data(), m.data(), er, ei);
    s.Vr = x[n];
    s.Vi = x[n + 1];
    s.Efd = D8(unit.operating.Efd);
    s.Tm = D8(unit.operating.Tm);
    terminal(er, ei, unit.y, s);
    unit.sensitivities.derivative(c.data(), x.data(), m.data(), s, dx.data());
    for (int col = from; col < to; ++col) {
      const int* place = places_[u].data() + col * members;
      const int k = col - from;
      for (int i = 0; i < n; ++i) values[place[i]] += (i == col ? a : 0.0) - dx[i].d[k];
      if (place[n] >= 0) values[place[n]] -= s.Ir.d[k] * unit.scale;
      if (place[n + 1] >= 0) values[place[n + 1]] -= s.Ii.d[k] * unit.scale;
    }
  }
}

}  // namespace swingbank::sim
