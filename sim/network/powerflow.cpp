#include "sim/network/powerflow.hpp"

#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/problem.hpp"
#include "sim/network/admittance.hpp"
#include "sim/network/connectivity.hpp"
#include "sim/network/detail/index.hpp"
#include "sim/network/detail/regulation.hpp"
#include "sim/network/detail/shunt_steps.hpp"
#include "sim/network/tie.hpp"

namespace swingbank::sim::network {
namespace {

/// Loads of each bus by voltage dependence.
struct Demand {
  std::vector<Complex> power, current, admittance;
};

Demand demand_of(const Network& n) {
  const std::size_t count = n.buses.size();
  Demand d{std::vector<Complex>(count), std::vector<Complex>(count), std::vector<Complex>(count)};
  for (const Load& l : n.loads) {
    d.power[as_index(l.bus)] += l.power;
    d.current[as_index(l.bus)] += l.current;
    d.admittance[as_index(l.bus)] += l.admittance;
  }
  return d;
}

/// Throws for a slack bus without a generator, and for buses without a path to a slack bus.
void check_slack(const Network& n, const std::vector<double>& supply) {
  Problems problems;
  std::vector<int> slacks, idle;
  for (std::size_t i = 0; i < n.buses.size(); ++i)
    if (n.buses[i].type == BusType::slack) {
      slacks.push_back(static_cast<int>(i));
      if (supply[i] == 0.0) idle.push_back(static_cast<int>(i));
    }
  if (slacks.empty())
    problems.add("no slack bus", n.origin, "one bus must set the angle and balance the power",
                 "make one generator bus type 3");
  if (!idle.empty())
    problems.add(
        "slack " + bus_list(n, idle) + (idle.size() == 1 ? " has" : " have") + " no generator in service",
        n.origin, "a slack bus needs a generator that balances the power",
        "put a generator in service or choose another slack bus");
  problems.raise();

  const auto island = islands(n);
  std::vector<char> has_slack(n.buses.size() + 1, 0);
  for (const int s : slacks) has_slack[as_index(island[as_index(s)])] = 1;
  std::vector<int> lost;
  for (std::size_t i = 0; i < island.size(); ++i)
    if (island[i] >= 0 && !has_slack[as_index(island[i])]) lost.push_back(static_cast<int>(i));
  if (!lost.empty())
    throw InputError({bus_list(n, lost) + (lost.size() == 1 ? " is" : " are") + " islanded", n.origin,
                      "no branch in service leads to the slack bus",
                      "close a branch, or make isolated buses type 4"});
}

/// Newton's method on angles, magnitudes and currents of ties. With a tie's current as an unknown, its
/// equation is linear in the voltages, so that start voltages that differ across the tie are harmless. If the
/// tie's power were computed from the voltages, its mismatch would be the square of that difference divided
/// by a small impedance.
class Newton {
 public:
  Newton(const Network& n, const Demand& demand)
      : n_(n),
        in_(demand),
        y_(bus_admittance(n, {}, TiesIn::equations)),
        ties_(ties(n)),
        tie_current_(ties_.size()) {}

  /// Sets the roles of the buses. Sets regulated magnitudes to their set-points; keeps all other voltages.
  void arrange(const Roles& roles) {
    roles_ = &roles;
    const int count = static_cast<int>(n_.buses.size());
    angle_.assign(as_index(count), -1);
    magnitude_.assign(as_index(count), -1);
    reactive_.assign(as_index(count), {});
    unknowns_ = 0;
    for (int i = 0; i < count; ++i) {
      const Role& role = roles[as_index(i)];
      if (role.kind == Role::out || role.kind == Role::slack) continue;
      angle_[as_index(i)] = unknowns_++;
      if (role.kind != Role::regulated) magnitude_[as_index(i)] = unknowns_++;
    }
    bus_unknowns_ = unknowns_;
    unknowns_ += 2 * static_cast<int>(ties_.size());
    // For each bus: the equations that contain its reactive power, with the factor of that power.
    for (int i = 0; i < count; ++i) {
      const Role& role = roles[as_index(i)];
      if (role.kind == Role::load) reactive_[as_index(i)].push_back({magnitude_[as_index(i)], 1.0});
      if (role.kind != Role::follows) continue;
      reactive_[as_index(i)].push_back({magnitude_[as_index(i)], roles[as_index(role.leader)].share});
      reactive_[as_index(role.leader)].push_back({magnitude_[as_index(i)], -role.share});
    }
    if (v_.size() == 0) return;
    for (int i = 0; i < count; ++i)
      if (roles[as_index(i)].kind == Role::regulated)
        v_[i] = std::polar(roles[as_index(i)].setpoint, std::arg(v_[i]));
  }

  /// Iterates from the present voltages. Returns true if every mismatch is within tolerance or rounding and
  /// no voltage has collapsed.
  bool iterate(double tolerance, int limit, int& iterations, double longest_step = kAnyStep) {
    for (int k = 0; k <= limit; ++k, ++iterations) {
      if (!evaluate()) return false;
      if (converged(tolerance)) return !collapsed();
      if (k == limit || !step(longest_step)) return false;
    }
    return false;
  }
  static constexpr double kAnyStep = 1e9;  ///< no limit of the step [rad, pu]
  /// Sets start voltages: the file's, or flat (1 pu, with the angles of the phase shifts).
  void start(bool flat) {
    std::ranges::fill(tie_current_, Complex{});
    v_.resize(static_cast<Eigen::Index>(n_.buses.size()));
    const std::vector<double> shifted = flat ? angles_of_shifts() : std::vector<double>{};
    for (std::size_t i = 0; i < n_.buses.size(); ++i) {
      const Bus& b = n_.buses[i];
      const Role& role = (*roles_)[i];
      const bool fixed = role.kind == Role::regulated || role.kind == Role::slack;
      const double vm = fixed ? role.setpoint : (flat ? 1.0 : b.vm);
      const double va = flat && role.kind != Role::slack ? shifted[i] : b.va;
      v_[static_cast<Eigen::Index>(i)] = role.kind == Role::out ? Complex{} : std::polar(vm, va);
    }
  }
  void add_susceptance(int bus, double more) { y_.coeffRef(bus, bus) += Complex(0.0, more); }
  [[nodiscard]] const Eigen::VectorXcd& voltage() const { return v_; }
  /// Returns the power of the generators at a bus [pu].
  [[nodiscard]] Complex delivered(int i) const { return v_[i] * std::conj(i_[i]) + load(i); }
  [[nodiscard]] double mismatch() const { return worst_; }
  [[nodiscard]] int worst_bus() const { return worst_bus_; }

 private:
  struct Row {
    int row;
    double factor;
  };
  /// Whether a voltage is far below nominal. Such a solution is not an operating point: without load, for
  /// example, V = 0 satisfies the equations of a bus.
  [[nodiscard]] bool collapsed() const {
    constexpr double least = 0.2;  // smallest voltage of an operating point [pu]
    for (Eigen::Index i = 0; i < v_.size(); ++i)
      if (role(static_cast<int>(i)).kind != Role::out && std::abs(v_[i]) < least) return true;
    return false;
  }
  /// Returns the angle of every bus if no power flows: the angle of its slack bus plus the phase shifts in
  /// between [rad].
  [[nodiscard]] std::vector<double> angles_of_shifts() const {
    std::vector<std::vector<std::pair<int, double>>> next(n_.buses.size());
    for (const Branch& b : n_.branches)
      if (b.in_service) {
        next[as_index(b.from)].emplace_back(b.to, -b.shift);
        next[as_index(b.to)].emplace_back(b.from, b.shift);
      }
    std::vector<double> angle(n_.buses.size());
    std::vector<char> known(n_.buses.size(), 0);
    std::vector<int> way;
    for (std::size_t i = 0; i < n_.buses.size(); ++i)
      if ((*roles_)[i].kind == Role::slack) {
        angle[i] = n_.buses[i].va;
        known[i] = 1;
        way.push_back(static_cast<int>(i));
      }
    for (std::size_t k = 0; k < way.size(); ++k)
      for (const auto& [to, turn] : next[as_index(way[k])])
        if (!std::exchange(known[as_index(to)], 1)) {
          angle[as_index(to)] = angle[as_index(way[k])] + turn;
          way.push_back(to);
        }
    return angle;
  }
  /// Returns row and column of the real part of a tie's current.
  [[nodiscard]] int tie_row(std::size_t k) const { return bus_unknowns_ + 2 * static_cast<int>(k); }
  /// Returns the residual of a tie's equation [pu]; zero below rounding.
  [[nodiscard]] Complex tie_mismatch(std::size_t k) const {
    const Tie& tie = ties_[k];
    const Complex from = v_[tie.from] / tie.ratio;
    const Complex rest = from - v_[tie.to] - tie.z * tie_current_[k];
    constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
    return std::abs(rest) <= rounding * std::abs(from) ? Complex{} : rest;
  }
  [[nodiscard]] const Role& role(int i) const { return (*roles_)[as_index(i)]; }
  [[nodiscard]] Complex load(int i) const {
    const double vm = std::abs(v_[i]);
    return in_.power[as_index(i)] + vm * (in_.current[as_index(i)] + vm * in_.admittance[as_index(i)]);
  }
  /// Computes the mismatches at the present voltages. Returns false if they are not finite.
  bool evaluate() {
    i_ = y_ * v_;
    f_ = Eigen::VectorXd::Zero(unknowns_);
    for (std::size_t k = 0; k < ties_.size(); ++k) {
      i_[ties_[k].from] += tie_current_[k] / std::conj(ties_[k].ratio);
      i_[ties_[k].to] -= tie_current_[k];
      const Complex rest = tie_mismatch(k);
      f_[tie_row(k)] = rest.real();
      f_[tie_row(k) + 1] = rest.imag();
    }
    for (int i = 0; i < v_.size(); ++i) {
      if (role(i).kind == Role::out) continue;
      const Complex d = delivered(i) - role(i).generation;
      if (angle_[as_index(i)] >= 0) f_[angle_[as_index(i)]] += d.real();
      for (const Row& r : reactive_[as_index(i)]) f_[r.row] += r.factor * d.imag();
      if (role(i).kind == Role::leads)
        f_[magnitude_[as_index(i)]] += std::abs(v_[role(i).target]) - role(i).setpoint;
    }
    double worst = 0.0;
    int bus = -1;
    for (int i = 0; i < v_.size(); ++i) {
      if (angle_[as_index(i)] < 0) continue;
      const double size =
          std::max(std::abs(f_[angle_[as_index(i)]]),
                   magnitude_[as_index(i)] >= 0 ? std::abs(f_[magnitude_[as_index(i)]]) : 0.0);
      if (!std::isfinite(size)) return false;
      if (bus < 0 || size > worst) {
        worst = size;
        bus = i;
      }
    }
    for (std::size_t k = 0; k < ties_.size(); ++k) {
      const double size = std::abs(Complex(f_[tie_row(k)], f_[tie_row(k) + 1]) / ties_[k].z);
      if (!std::isfinite(size)) return false;
      if (size > worst) {
        worst = size;
        bus = ties_[k].from;
      }
    }
    worst_ = worst;
    worst_bus_ = bus;
    return true;
  }
  /// Mismatches below a few units in the last place of the powers at the bus count as rounding.
  [[nodiscard]] bool converged(double tolerance) const {
    Eigen::VectorXd meeting = Eigen::VectorXd::Zero(v_.size());
    for (int j = 0; j < y_.outerSize(); ++j)
      for (Eigen::SparseMatrix<Complex>::InnerIterator e(y_, j); e; ++e)
        meeting[e.row()] += std::abs(v_[e.row()]) * std::abs(e.value()) * std::abs(v_[j]);
    for (std::size_t k = 0; k < ties_.size(); ++k) {
      if (std::abs(Complex(f_[tie_row(k)], f_[tie_row(k) + 1])) > tolerance * std::abs(ties_[k].z))
        return false;
      for (const int end : {ties_[k].from, ties_[k].to})
        meeting[end] += std::abs(v_[end]) * std::abs(tie_current_[k]);
    }
    constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
    for (int i = 0; i < v_.size(); ++i) {
      double meets = meeting[i];
      if (role(i).kind == Role::follows) meets += meeting[role(i).leader];
      for (const int k : {angle_[as_index(i)], magnitude_[as_index(i)]})
        if (k >= 0 && std::abs(f_[k]) > std::max(tolerance, rounding * meets)) return false;
    }
    return true;
  }
  /// Performs one Newton step with dS/d(angle) and dS/d|V|.
  bool step(double longest) {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int i, int column, Complex d) {
      if (column < 0) return;
      if (angle_[as_index(i)] >= 0) entries.emplace_back(angle_[as_index(i)], column, d.real());
      for (const Row& r : reactive_[as_index(i)]) entries.emplace_back(r.row, column, r.factor * d.imag());
    };
    const Complex j1(0.0, 1.0);
    for (int j = 0; j < y_.outerSize(); ++j) {
      if (role(j).kind == Role::out) continue;
      for (Eigen::SparseMatrix<Complex>::InnerIterator e(y_, j); e; ++e) {
        const int i = static_cast<int>(e.row());
        const Complex flow = v_[i] * std::conj(e.value() * v_[j]);
        add(i, angle_[as_index(j)], -j1 * flow);
        add(i, magnitude_[as_index(j)], flow / std::abs(v_[j]));
      }
      const double vm = std::abs(v_[j]);
      const Complex own = v_[j] * std::conj(i_[j]);
      add(j, angle_[as_index(j)], j1 * own);
      add(j, magnitude_[as_index(j)],
          own / vm + in_.current[as_index(j)] + 2.0 * vm * in_.admittance[as_index(j)]);
      if (role(j).kind == Role::leads)
        entries.emplace_back(magnitude_[as_index(j)], magnitude_[as_index(role(j).target)], 1.0);
    }
    for (std::size_t k = 0; k < ties_.size(); ++k) {
      const Tie& tie = ties_[k];
      const int row = tie_row(k);
      const auto in_row = [&](int column, Complex d) {
        if (column < 0) return;
        entries.emplace_back(row, column, d.real());
        entries.emplace_back(row + 1, column, d.imag());
      };
      for (const bool at_from : {true, false}) {
        const int end = at_from ? tie.from : tie.to;
        const Complex v = at_from ? v_[end] / tie.ratio : -v_[end];
        in_row(angle_[as_index(end)], j1 * v);
        in_row(magnitude_[as_index(end)], v / std::abs(v_[end]));
        add(end, row, v);
        add(end, row + 1, -j1 * v);
      }
      in_row(row, -tie.z);
      in_row(row + 1, -j1 * tie.z);
    }
    Eigen::SparseMatrix<double> jacobian(unknowns_, unknowns_);
    jacobian.setFromTriplets(entries.begin(), entries.end());
    Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(jacobian);
    if (lu.info() != Eigen::Success) return false;
    const Eigen::VectorXd dx = lu.solve(f_);
    if (!dx.allFinite()) return false;
    const double most = bus_unknowns_ > 0 ? dx.head(bus_unknowns_).cwiseAbs().maxCoeff() : 0.0;
    const double share = most > longest ? longest / most : 1.0;
    for (std::size_t k = 0; k < ties_.size(); ++k)
      tie_current_[k] -= share * Complex(dx[tie_row(k)], dx[tie_row(k) + 1]);
    for (int i = 0; i < v_.size(); ++i) {
      if (angle_[as_index(i)] < 0) continue;
      const double vm =
          std::abs(v_[i]) - (magnitude_[as_index(i)] >= 0 ? share * dx[magnitude_[as_index(i)]] : 0.0);
      v_[i] = (role(i).kind == Role::regulated ? role(i).setpoint : vm) *
              std::polar(1.0, std::arg(v_[i]) - share * dx[angle_[as_index(i)]]);
    }
    return true;
  }

  const Network& n_;
  const Demand& in_;
  const Roles* roles_ = nullptr;
  Eigen::SparseMatrix<Complex> y_;  ///< bus admittance matrix without ties
  std::vector<Tie> ties_;
  std::vector<Complex> tie_current_;        ///< currents of ties into bus `to` [pu]
  std::vector<int> angle_, magnitude_;      ///< position of each bus's unknowns, or -1
  std::vector<std::vector<Row>> reactive_;  ///< per bus
  int bus_unknowns_ = 0, unknowns_ = 0;
  Eigen::VectorXcd v_, i_;
  Eigen::VectorXd f_;
  double worst_ = 0.0;
  int worst_bus_ = -1;
};

/// Solves with the present roles. Tries in turn the present voltages (if `limited`), the file's voltages and
/// a flat start; then both again with shorter steps. Throws InputError if all starts fail.
void solve(Newton& newton, const Network& network, const PowerFlowOptions& options, bool limited,
           int& iterations) {
  if (limited && newton.iterate(options.tolerance, options.limit, iterations)) return;
  newton.start(false);
  if (newton.iterate(options.tolerance, options.limit, iterations)) return;
  newton.start(true);  // in case the file's voltages are a poor start
  if (newton.iterate(options.tolerance, options.limit, iterations)) return;
  constexpr double short_step = 0.1;  // longest step [rad, pu]
  constexpr int more = 5;             // factor of the iteration limit
  for (const bool flat : {false, true}) {
    newton.start(flat);
    if (newton.iterate(options.tolerance, more * options.limit, iterations, short_step)) return;
  }
  const double size = newton.mismatch();
  if (size <= options.tolerance)
    throw InputError({"the power flow balances only with a voltage below 0.2 pu", network.origin,
                      "this is not an operating point: the grid cannot supply its loads",
                      "check loads and impedances, or keep the file's voltages (--start file)"});
  throw InputError(
      {"the power flow diverges, worst at " + bus_list(network, {newton.worst_bus()}) +
           " with a mismatch of " + std::to_string(size) + " pu (" + std::to_string(size * network.base_mva) +
           " MVA)" + (limited ? ", with generators at their reactive limits" : ""),
       network.origin,
       std::to_string(options.limit) +
           " iterations did not converge, neither from the file's voltages nor from a flat start, and "
           "more iterations with short steps did not either",
       std::string("check loads, dispatch and impedances near that bus") +
           (limited ? ", ignore the limits (--q-limits ignore)" : "") +
           ", or keep the file's voltages (--start file)"});
}

/// Shares the power of a bus among its generators, without limits. If the power is nearly the sum of the
/// file's values, each generator keeps its P and Q of the file, as in PSS/E. The difference is then shared by
/// MVA. Otherwise the whole power is shared by MVA.
void share_freely(const Network& n, const std::vector<std::size_t>& units, double mva, Complex power,
                  std::vector<Complex>& generation) {
  Complex rest = power;
  for (const std::size_t k : units) rest -= Complex(n.generators[k].p, n.generators[k].q);
  constexpr double near = 0.01;  // fraction of the units' MVA
  const bool of_file = units.size() > 1 && std::abs(rest) * n.base_mva <= near * mva;
  for (const std::size_t k : units) {
    const Generator& g = n.generators[k];
    generation[k] = of_file ? Complex(g.p, g.q) + rest * (g.mva / mva) : power * (g.mva / mva);
  }
}

/// As share_freely(), but within each generator's reactive limits if the limits of all permit it.
void share_out(const Network& n, int bus, Complex power, const PowerFlowOptions& options,
               std::vector<Complex>& generation) {
  std::vector<std::size_t> units;
  double mva = 0.0;
  for (std::size_t k = 0; k < n.generators.size(); ++k)
    if (n.generators[k].bus == bus && n.generators[k].in_service) {
      units.push_back(k);
      mva += n.generators[k].mva;
    }
  const bool slack = n.buses[as_index(bus)].type == BusType::slack;
  share_freely(n, units, mva, power, generation);
  if (!slack)
    for (const std::size_t k : units) generation[k] = {n.generators[k].p, generation[k].imag()};
  if (slack || !options.reactive_limits || units.size() < 2) return;
  const auto within = [&](std::size_t k) {
    const Generator& g = n.generators[k];
    return g.q_min <= g.q_max ? std::clamp(generation[k].imag(), g.q_min, g.q_max) : generation[k].imag();
  };
  std::vector<std::size_t> open = units;
  while (true) {  // moves excess to units with reserve; at most one iteration per unit
    double rest = power.imag(), free_mva = 0.0;
    std::vector<std::size_t> free;
    for (const std::size_t k : units) {
      const bool was_open = std::ranges::count(open, k) > 0;
      const double q = within(k);
      rest -= q;
      if (!was_open || q != generation[k].imag()) {
        generation[k] = {generation[k].real(), q};
      } else {
        free.push_back(k);
        free_mva += n.generators[k].mva;
      }
    }
    if (free.size() == open.size() || free.empty()) {
      if (free.empty())  // the power exceeds the sum of the limits: type-1 bus, or q_min above q_max
        for (const std::size_t k : units) generation[k] += Complex(0.0, rest * n.generators[k].mva / mva);
      return;
    }
    for (const std::size_t k : free) generation[k] += Complex(0.0, rest * n.generators[k].mva / free_mva);
    open = free;
  }
}

PowerFlow result_of(const Newton& newton, const Network& network, const PowerFlowOptions& options) {
  PowerFlow flow;
  flow.mismatch = newton.mismatch();
  flow.voltage.assign(newton.voltage().begin(), newton.voltage().end());
  flow.generation.assign(network.generators.size(), {});
  std::vector<char> done(network.buses.size(), 0);
  for (const Generator& g : network.generators)
    if (g.in_service && !std::exchange(done[as_index(g.bus)], 1))
      share_out(network, g.bus, newton.delivered(g.bus), options, flow.generation);
  return flow;
}

}  // namespace

PowerFlow solve_power_flow(const Network& network, const PowerFlowOptions& options) {
  const Demand demand = demand_of(network);
  Regulation regulation(network);
  check_slack(network, regulation.supply());
  Newton newton(network, demand);
  int iterations = 0;
  newton.arrange(regulation.roles());
  solve(newton, network, options, false, iterations);
  const auto magnitude = [&](int bus) { return std::abs(newton.voltage()[bus]); };
  const auto within_limits = [&] {
    while (options.reactive_limits &&
           regulation.limit([&](int bus) { return newton.delivered(bus).imag(); }, magnitude)) {
      newton.arrange(regulation.roles());
      solve(newton, network, options, true, iterations);
    }
  };
  within_limits();
  ShuntSteps steps(network);
  while (options.step_shunts &&
         steps.step(magnitude, [&](int bus, double more) { newton.add_susceptance(bus, more); })) {
    solve(newton, network, options, true, iterations);
    within_limits();
  }
  PowerFlow flow = result_of(newton, network, options);
  flow.iterations = iterations;
  flow.at_limit = regulation.at_limit();
  if (options.step_shunts) flow.stepped = steps.result(magnitude);
  return flow;
}

}  // namespace swingbank::sim::network
