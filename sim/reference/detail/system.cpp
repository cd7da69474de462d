#include "sim/reference/detail/system.hpp"

#include <fmt/format.h>

#include <Eigen/SparseLU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "sim/network/admittance.hpp"
#include "sim/network/connectivity.hpp"

namespace swingbank::sim::reference {
namespace {

/// Maximum number of remote buses of a unit: one regulated bus and both ends of a branch.
constexpr std::size_t kMostSeen = 3;

int delta_state(const Effect& machine) {
  for (std::size_t i = 0; i < machine.states.size(); ++i)
    if (machine.states[i].name == "delta") return static_cast<int>(i);
  return -1;
}

/// Returns the buses of islands that have converters but neither machine nor fault. The equations of such an
/// island have no solution, because a converter follows a voltage and does not set one.
std::vector<int> cut_off(const grid::Grid& grid, const network::Topology& topology) {
  const std::vector<int> island = network::islands(grid.network, topology.open);
  std::vector<bool> has_source(island.size() + 1, false);
  for (const plant::Plant& plant : grid.plants)
    if (!plant.machine.effect->converter && !std::ranges::binary_search(topology.tripped, plant.generator))
      has_source[island[plant.bus] + 1] = true;
  for (const auto& [bus, z] : topology.faults) has_source[island[bus] + 1] = true;
  for (const int bus : network::dead_buses(grid.network, topology))
    has_source[island[bus] + 1] = true;  // V = 0
  has_source[0] = true;                  // isolated buses (-1) are out of the grid
  std::vector<int> lost;
  for (int b = 0; b < static_cast<int>(island.size()); ++b)
    if (!has_source[island[b] + 1]) lost.push_back(b);
  return lost;
}

template <class T>
const std::vector<T>& coefficients(const ReferencePlants::Unit& unit) {
  if constexpr (std::is_same_v<T, double>)
    return unit.operating.c;
  else
    return unit.coefficients;
}
template <class T>
const auto& plant_equations(const ReferencePlants::Unit& unit) {
  if constexpr (std::is_same_v<T, double>)
    return *unit.equations;
  else
    return *unit.sensitivities;
}
template <class T>
const auto& load_equations(const ReferencePlants::Unit& unit) {
  if constexpr (std::is_same_v<T, double>)
    return *unit.consumption;
  else
    return *unit.consumption_sensitivities;
}

/// Sets the remote buses of a plant control.
void see_far(const network::Network& network, ReferencePlants::Unit& unit) {
  const auto& [bus, branch, at_from] = unit.plant->far_place;
  if (bus >= 0) unit.seen.push_back(bus);
  if (branch < 0) return;
  const network::Branch& b = network.branches[static_cast<std::size_t>(branch)];
  unit.flow = network::branch_end(b, at_from);
  unit.seen.push_back(at_from ? b.from : b.to);
  unit.seen.push_back(at_from ? b.to : b.from);
}

/// Returns the current at the end of a branch from the voltages at both ends.
template <class T>
std::pair<T, T> flow(const network::BranchEnd& end, const T* near, const T* far) {
  const T gn(end.own.real()), bn(end.own.imag()), gf(end.other.real()), bf(end.other.imag());
  return {gn * near[0] - bn * near[1] + gf * far[0] - bf * far[1],
          gn * near[1] + bn * near[0] + gf * far[1] + bf * far[0]};
}

}  // namespace

ReferencePlants::ReferencePlants(const grid::Grid& grid) {
  units_.reserve(grid.plants.size() + grid.loads.size());
  std::map<std::vector<const Effect*>, int> kinds;
  const auto kind_of = [&](const std::vector<const Effect*>& effects) {
    return kinds.try_emplace(effects, static_cast<int>(kinds.size())).first->second;
  };
  const auto place = [&](Unit unit) {
    unit.coefficients.assign(unit.operating.c.begin(), unit.operating.c.end());
    unit.first = states_;
    states_ += unit.states;
    units_.push_back(std::move(unit));
  };
  for (const plant::Plant& plant : grid.plants) {
    Unit unit;
    unit.plant = &plant;
    unit.operating =
        plant::operating_point(plant, grid.flow.voltage[plant.bus], grid.network.base_mva, grid.conventions);
    unit.equations.emplace(plant);
    unit.sensitivities.emplace(plant);
    unit.bus = plant.bus;
    std::vector<const Effect*> effects = {plant.machine.effect, plant.transformer.effect};
    for (const plant::Block& block : plant.controls) effects.push_back(block.effect);
    see_far(grid.network, unit);
    effects.resize(effects.size() + unit.seen.size());
    unit.kind = kind_of(effects);
    unit.states = unit.equations->states();
    unit.delta = delta_state(*plant.machine.effect);
    unit.scale = plant.mva / grid.network.base_mva;
    place(std::move(unit));
    const auto more = plant::switching_times_of(plant);
    switching_times_.insert(switching_times_.end(), more.begin(), more.end());
  }
  for (const plant::Consumer& load : grid.loads) {
    Unit unit;
    unit.load = &load;
    if (load.regulated >= 0 && load.regulated != load.bus) unit.seen = {load.regulated};
    unit.operating = plant::load_operating_point(
        load, load.block.p, grid.flow.voltage[load.bus], grid.network.base_mva, grid.conventions,
        grid.flow.voltage[unit.seen.empty() ? load.bus : unit.seen[0]]);
    unit.consumption.emplace(load);
    unit.consumption_sensitivities.emplace(load);
    unit.bus = load.bus;
    unit.kind = kind_of({load.block.effect, unit.seen.empty() ? nullptr : load.block.effect});
    unit.states = unit.consumption->states();
    unit.delta = -1;
    unit.scale = load.mva / grid.network.base_mva;
    place(std::move(unit));
  }
}

ReferenceSystem::ReferenceSystem(const grid::Grid& grid, const ReferencePlants& plants,
                                 const network::Segment& segment, double end)
    : plants_(plants),
      buses_(static_cast<int>(grid.network.buses.size())),
      last_moment_(end - plant::kBeforeSwitching),
      bolted_(buses_, false),
      open_(segment.topology.open),
      island_(network::islands(grid.network, segment.topology.open)),
      connected_(plants.units().size(), 1.0),
      setpoint_(plants.units().size()) {
  for (std::size_t u = 0; u < plants.units().size(); ++u) {
    if (!plants.units()[u].plant) continue;
    const int generator = plants.units()[u].plant->generator;
    connected_[u] = segment.topology.connected(generator);
    for (const network::Setpoint& move : segment.setpoints)
      if (move.generator == generator) setpoint_[u] = move;
  }
  if (const std::vector<int> lost = cut_off(grid, segment.topology); !lost.empty())
    throw InputError({"islanded converters: " + network::bus_list(grid.network, lost), grid.network.origin,
                      "that part of the grid has neither machine nor fault",
                      "keep a branch to it closed, or remove it from the network"});
  build_network(grid, segment.topology);
}

void ReferenceSystem::build_network(const grid::Grid& grid, const network::Topology& topology) {
  for (int b : network::grounded_buses(grid.network, topology)) bolted_[b] = true;
  for (int b = 0; b < buses_; ++b)
    if (grid.network.buses[b].type == network::BusType::isolated)
      bolted_[b] = true;  // outside the grid: V = 0
  const std::vector<int> modelled = grid.modelled_loads();
  const auto matrix = [&](network::TiesIn ties) {
    Rows y = network::dynamic_admittance(grid.network, grid.flow, topology, modelled, ties);
    y.prune([&](Eigen::Index row, Eigen::Index, const Complex&) { return !bolted_[row]; });
    return y;
  };
  y_ = matrix(network::TiesIn::equations);
  ties_ = network::ties(grid.network, topology);
  build_pattern(matrix(network::TiesIn::matrix));
}

void ReferenceSystem::build_pattern(const Rows& y) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int col, double value) { entries.emplace_back(row, col, value); };
  for (int b = 0; b < buses_; ++b) {
    const int row = bus_row(b);
    if (bolted_[b]) {
      add(row, row, 1.0);
      add(row + 1, row + 1, 1.0);
    }
    for (Rows::InnerIterator it(y, b); it; ++it) {
      const int col = bus_row(static_cast<int>(it.col()));
      add(row, col, it.value().real());
      add(row, col + 1, -it.value().imag());
      add(row + 1, col, it.value().imag());
      add(row + 1, col + 1, it.value().real());
    }
  }
  std::vector<std::vector<int>> members;
  for (const Unit& unit : plants_.units()) {
    std::vector<int>& index = members.emplace_back(unit.states);
    std::iota(index.begin(), index.end(), unit.first);
    index.push_back(bus_row(unit.bus));
    index.push_back(bus_row(unit.bus) + 1);
    for (const int bus : unit.seen)
      for (const int part : {0, 1}) index.push_back(bus_row(bus) + part);
    for (int col : index)
      for (int row : index)
        if (row < plants_.states() || !bolted_[unit.bus]) add(row, col, 0.0);
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
        const bool fixed = row >= plants_.states() && bolted_[plants_.units()[u].bus];
        places_[u].push_back(found && !fixed ? static_cast<int>(place - inner) : -1);
      }
}

/// Sets the remote measurement of a plant control that names a bus or a branch.
template <class T>
void ReferenceSystem::look_far(const Unit& unit, const T* seen, Signals<T>& s) const {
  const plant::FarPlace& place = unit.plant->far_place;
  if (place.bus >= 0) {
    s.far.Vr = seen[0];
    s.far.Vi = seen[1];
    seen += 2;
  }
  if (place.branch < 0) return;
  const bool open = std::ranges::binary_search(open_, place.branch);
  const auto [ir, ii] = open ? std::pair(T(0.0), T(0.0)) : flow(unit.flow, seen, seen + 2);
  const T scale(1.0 / unit.scale);
  s.far.Ir = ir * scale;
  s.far.Ii = ii * scale;
  s.far.P = seen[0] * s.far.Ir + seen[1] * s.far.Ii;
  s.far.Q = seen[1] * s.far.Ir - seen[0] * s.far.Ii;
}

/// Evaluates one unit at the voltage v of its bus and those of its remote buses: signals, derivatives of its
/// states, current into the grid.
template <class T>
Signals<T> ReferenceSystem::evaluate(std::size_t u, double t, const T* x, const T* v, const T* seen, T* dx,
                                     T& ir, T& ii) const {
  const Unit& unit = plants_.units()[u];
  const T* c = coefficients<T>(unit).data();
  Signals<T> s;
  s.Vpr = s.Vr = v[0];
  s.Vpi = s.Vi = v[1];
  s.t = T(std::min(t, last_moment_));
  if (unit.load) {
    if (!unit.seen.empty()) s.Vpr = seen[0], s.Vpi = seen[1];
    load_equations<T>(unit).current(c, x, s);
    load_equations<T>(unit).derivative(c, x, s, dx);
    ir = s.Ir;
    ii = s.Ii;
    return s;
  }
  s.Efd = T(unit.operating.Efd);
  s.Tm = T(unit.operating.Tm);
  s.dVref = T(setpoint_[u].dVref);
  s.dPref = T(setpoint_[u].dPref);
  const auto& equations = plant_equations<T>(unit);
  std::vector<T>& m = scratch<T>().m;
  if (static_cast<int>(m.size()) < equations.scratch())
    m.resize(static_cast<std::size_t>(equations.scratch()));
  T er, ei;
  equations.emf(c, x, m.data(), er, ei);
  if (tripped(u)) {  // disconnected, open circuit
    s.Vpr = er;
    s.Vpi = ei;
  }
  equations.from_grid(c, x, m.data(), er, ei, s, ir, ii);
  if (!unit.seen.empty()) look_far(unit, seen, s);
  equations.derivative(c, x, m.data(), s, dx);
  if (tripped(u)) std::fill(dx, dx + unit.states, T(0.0));
  return s;
}

Signals<double> ReferenceSystem::signals(std::size_t u, double t, const double* y, Complex& current,
                                         double* dx) const {
  const Unit& unit = plants_.units()[u];
  std::vector<double>& unused = scratch<double>().dx;
  if (!dx) unused.resize(static_cast<std::size_t>(unit.states));
  const double* v = y + bus_row(unit.bus);
  double ir, ii;
  std::array<double, 2 * kMostSeen> seen;
  for (std::size_t k = 0; k < 2 * unit.seen.size(); ++k) seen[k] = y[bus_row(unit.seen[k / 2]) + k % 2];
  const auto s = evaluate<double>(u, t, y + unit.first, v, seen.data(), dx ? dx : unused.data(), ir, ii);
  current = {ir, ii};
  return s;
}

bool ReferenceSystem::newton(double t, double* y) const {
  constexpr int limit = 50;
  constexpr double tolerance = 1e-12;  // [pu of voltage], above the rounding error
  std::vector<double> yp(size(), 0.0), f(size());
  Eigen::SparseMatrix<double> j = constant_;
  for (int iteration = 0; iteration < limit; ++iteration) {
    for (int b = 0; b < buses_; ++b)
      if (bolted_[b]) y[bus_row(b)] = y[bus_row(b) + 1] = 0.0;
    residual(t, y, yp.data(), f.data());
    jacobian(t, 0.0, y, j.valuePtr());
    const Eigen::SparseMatrix<double> jv = j.bottomRightCorner(2 * buses_, 2 * buses_);
    Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(jv);
    if (lu.info() != Eigen::Success) return false;
    const auto correction = [&] {
      const Eigen::Map<const Eigen::VectorXd> rest(f.data() + plants_.states(), 2 * buses_);
      Eigen::VectorXd step = lu.solve(rest);
      step += lu.solve(rest - jv * step).eval();  // refinement: a fault of 1e-6 pu is ill-conditioned
      return step;
    };
    const Eigen::VectorXd step = correction();
    const double largest = step.cwiseAbs().maxCoeff();
    if (!std::isfinite(largest)) return false;
    // A constant-power load may make the first steps very long. At the limits of a converter the equations
    // have kinks, between which full steps may alternate: a step is halved until it shortens the next
    // correction (natural monotonicity test, P. Deuflhard, Newton Methods for Nonlinear Problems, 2004,
    // section 3.3).
    const std::vector<double> before(y + plants_.states(), y + size());
    const auto move = [&](double share) {
      for (int i = 0; i < 2 * buses_; ++i)
        y[plants_.states() + i] = before[static_cast<std::size_t>(i)] - share * step[i];
    };
    const auto shortens = [&](double share) {
      residual(t, y, yp.data(), f.data());
      return correction().norm() <= (1 - share / 4) * step.norm();
    };
    const double longest = 1.0 / std::max(1.0, largest), shortest = longest / 64;
    double share = longest;
    for (move(share); largest >= tolerance && !shortens(share); move(share))
      if ((share /= 2) < shortest) {
        move(longest);
        break;
      }
    if (largest < tolerance) break;
    if (iteration + 1 == limit) return false;
  }
  for (int b = 0; b < buses_; ++b)
    if (bolted_[b]) y[bus_row(b)] = y[bus_row(b) + 1] = 0.0;
  return true;
}

bool ReferenceSystem::search_voltages(double t, double* y) const {
  if (newton(t, y)) return true;
  for (const double from : {0.0, 1.0}) {
    for (int b = 0; b < buses_; ++b) y[bus_row(b)] = from, y[bus_row(b) + 1] = 0.0;
    if (newton(t, y)) return true;
  }
  return false;
}

void ReferenceSystem::solve_voltages(double t, double* y) const {
  if (search_voltages(t, y)) return;
  throw InputError({"the network equations have no voltage solution", fmt::format("t = {:g} s", t),
                    "loads and sources demand more than the grid can deliver after this switching",
                    "use load models whose power decreases at low voltage, or another event"});
}

void ReferenceSystem::derivatives(double t, const double* y, double* yp) const {
  std::fill(yp, yp + size(), 0.0);
  Complex unused;
  for (std::size_t u = 0; u < plants_.units().size(); ++u)
    (void)signals(u, t, y, unused, yp + plants_.units()[u].first);
}

void ReferenceSystem::residual(double t, const double* y, const double* yp, double* f) const {
  for (int b = 0; b < buses_; ++b) {
    const double* v = y + bus_row(b);
    Complex current = bolted_[b] ? Complex(v[0], v[1]) : Complex();
    for (Rows::InnerIterator it(y_, b); it; ++it) {
      const double* w = y + bus_row(static_cast<int>(it.col()));
      current += it.value() * Complex(w[0], w[1]);
    }
    f[bus_row(b)] = current.real();
    f[bus_row(b) + 1] = current.imag();
  }
  for (const network::Tie& tie : ties_) tie_current(tie, y, f);
  for (std::size_t u = 0; u < plants_.units().size(); ++u) {
    const Unit& unit = plants_.units()[u];
    double* dx = f + unit.first;
    Complex current;
    (void)signals(u, t, y, current, dx);
    for (int i = 0; i < unit.states; ++i) dx[i] = yp[unit.first + i] - dx[i];
    if (bolted_[unit.bus] || tripped(u)) continue;
    const double scale = unit.scale * connected_[u];
    f[bus_row(unit.bus)] -= current.real() * scale;
    f[bus_row(unit.bus) + 1] -= current.imag() * scale;
  }
}

/// Adds the current of a tie, a branch of very small impedance, to the current balances of its buses. The
/// current is the difference of two nearly equal voltages divided by this impedance. Its rounding error
/// enters both balances with opposite signs and therefore does not affect the voltages.
void ReferenceSystem::tie_current(const network::Tie& tie, const double* y, double* f) const {
  const double *from = y + bus_row(tie.from), *to = y + bus_row(tie.to);
  const Complex into = (Complex(from[0], from[1]) / tie.ratio - Complex(to[0], to[1])) / tie.z;
  const auto add = [&](int bus, Complex current) {
    if (bolted_[bus]) return;
    f[bus_row(bus)] += current.real();
    f[bus_row(bus) + 1] += current.imag();
  };
  add(tie.from, into / std::conj(tie.ratio));
  add(tie.to, -into);
}

std::vector<double> ReferenceSystem::error_weights() const {
  constexpr double kStabiliser = 30.0, kExciter = 10.0, kMachine = 10.0;  // error weights, decision 05
  std::vector<double> weight(static_cast<std::size_t>(size()), 1.0);
  for (const Unit& unit : plants_.units()) {
    if (!unit.plant) continue;
    double* at = std::fill_n(weight.data() + unit.first, unit.plant->machine.effect->states.size(), kMachine);
    for (const plant::Block& block : unit.plant->controls) {
      const Slot slot = block.effect->slot;
      const double w = slot == Slot::stabiliser ? kStabiliser : slot == Slot::exciter ? kExciter : 1.0;
      at = std::fill_n(at, block.effect->states.size(), w);
    }
  }
  return weight;
}

bool ReferenceSystem::clamp_states(double* y) const {
  double moved = 0.0;
  for (const Unit& unit : plants_.units())
    if (unit.equations) unit.equations->clamp_states(unit.operating.c.data(), y + unit.first, moved);
  return moved > 0.0;
}

void ReferenceSystem::jacobian(double t, double a, const double* y, double* values) const {
  std::copy(constant_.valuePtr(), constant_.valuePtr() + constant_.nonZeros(), values);
  for (std::size_t u = 0; u < plants_.units().size(); ++u) unit_jacobian(u, t, a, y, values);
}

void ReferenceSystem::unit_jacobian(std::size_t u, double t, double a, const double* y,
                                    double* values) const {
  const Unit& unit = plants_.units()[u];
  const int n = unit.states, members = unit.members(), row = bus_row(unit.bus);
  const double scale = unit.scale * connected_[u];
  std::vector<D8>&x = scratch<D8>().x, &dx = scratch<D8>().dx;
  x.resize(static_cast<std::size_t>(members));
  dx.resize(static_cast<std::size_t>(n));
  for (int from = 0; from < members; from += kSensitivities) {
    for (int i = 0; i < n; ++i) x[i] = D8(y[unit.first + i]);
    for (int i = n; i < members; ++i) {
      const int k = i - n;  // voltages of its own bus, then of its remote buses
      x[i] = D8(y[(k < 2 ? row : bus_row(unit.seen[k / 2 - 1])) + k % 2]);
    }
    const int to = std::min(from + kSensitivities, members);
    for (int i = from; i < to; ++i) x[i].d.set(i - from, 1.0);
    D8 ir, ii;
    (void)evaluate<D8>(u, t, x.data(), &x[n], &x[n] + 2, dx.data(), ir, ii);
    for (int col = from; col < to; ++col) {
      const int* place = places_[u].data() + col * members;
      const int k = col - from;
      for (int i = 0; i < n; ++i) values[place[i]] += (i == col ? a : 0.0) - dx[i].d[k];
      if (tripped(u)) continue;
      if (place[n] >= 0) values[place[n]] -= ir.d[k] * scale;
      if (place[n + 1] >= 0) values[place[n + 1]] -= ii.d[k] * scale;
    }
  }
}

}  // namespace swingbank::sim::reference
