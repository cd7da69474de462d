#include "sim/network/powerflow.hpp"

#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <cmath>
#include <limits>

#include "base/problem.hpp"
#include "sim/network/admittance.hpp"
#include "sim/network/connectivity.hpp"

namespace swingbank::sim::network {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// What stands at each bus: dispatch, held voltage, loads by their dependence on voltage.
struct Injections {
  std::vector<Complex> generation, power, current, admittance;
  std::vector<double> held;  ///< voltage a generator holds [pu], 0 where none does
};

Injections collect(const Network& n) {
  const std::size_t count = n.buses.size();
  Injections in{std::vector<Complex>(count), std::vector<Complex>(count), std::vector<Complex>(count),
                std::vector<Complex>(count), std::vector<double>(count)};
  for (const Generator& g : n.generators) {
    if (!g.in_service) continue;
    in.generation[at(g.bus)] += Complex(g.p, 0.0);
    in.held[at(g.bus)] = g.vset;
  }
  for (const Load& l : n.loads) {
    in.power[at(l.bus)] += l.power;
    in.current[at(l.bus)] += l.current;
    in.admittance[at(l.bus)] += l.admittance;
  }
  return in;
}

/// Index of the one slack bus; throws for none or several and for buses that no path joins to it.
int check_slack(const Network& n, const Injections& in) {
  Problems problems;
  std::vector<int> slacks;
  for (std::size_t i = 0; i < n.buses.size(); ++i)
    if (n.buses[i].type == BusType::slack) slacks.push_back(static_cast<int>(i));
  if (slacks.empty())
    problems.add("no slack bus", n.origin, "one bus must set the angle and balance the power",
                 "make one generator bus type 3");
  if (slacks.size() > 1)
    problems.add("several slack buses: " + bus_list(n, slacks), n.origin, "one bus balances the power",
                 "leave one of them type 3 and make the others type 2");
  for (const int s : slacks)
    if (in.held[at(s)] == 0.0)
      problems.add("slack " + bus_list(n, {s}) + " has no generator in service", n.origin,
                   "nothing there can balance the power",
                   "put a generator in service or choose another slack bus");
  problems.raise();

  const auto island = islands(n);
  std::vector<int> lost;
  for (std::size_t i = 0; i < island.size(); ++i)
    if (island[i] >= 0 && island[i] != island[at(slacks[0])]) lost.push_back(static_cast<int>(i));
  if (!lost.empty())
    throw InputError({bus_list(n, lost) + (lost.size() == 1 ? " is" : " are") + " islanded", n.origin,
                      "no branch in service leads to the slack bus",
                      "close a branch, or make isolated buses type 4"});
  return slacks[0];
}

class Newton {
 public:
  Newton(const Network& n, int slack, const Injections& in)
      : n_(n), in_(in), slack_(slack), y_(bus_admittance(n)) {
    const int count = static_cast<int>(n.buses.size());
    angle_.assign(at(count), -1);
    magnitude_.assign(at(count), -1);
    for (int i = 0; i < count; ++i) {
      if (!live(i) || i == slack) continue;
      angle_[at(i)] = unknowns_++;
      if (in.held[at(i)] == 0.0) magnitude_[at(i)] = unknowns_++;
    }
  }

  /// Iterates from the present voltages; true if every mismatch is within tolerance (or rounding, see
  /// `floor`).
  bool iterate(double tolerance, int limit, int& iterations) {
    for (iterations = 0; iterations <= limit; ++iterations) {
      if (!evaluate()) return false;
      if (converged(tolerance)) return true;
      if (iterations == limit || !step()) return false;
    }
    return false;
  }
  void start(bool flat) {
    v_.resize(static_cast<Eigen::Index>(n_.buses.size()));
    for (std::size_t i = 0; i < n_.buses.size(); ++i) {
      const Bus& b = n_.buses[i];
      const double vm = in_.held[i] > 0.0 ? in_.held[i] : (flat ? 1.0 : b.vm);
      const double va = flat ? n_.buses[at(slack_)].va : b.va;
      v_[static_cast<Eigen::Index>(i)] = live(static_cast<int>(i)) ? std::polar(vm, va) : Complex{};
    }
  }
  [[nodiscard]] const Eigen::VectorXcd& voltage() const { return v_; }
  /// Power the generators of a bus must deliver [pu].
  [[nodiscard]] Complex delivered(int i) const { return v_[i] * std::conj(i_[i]) + load(i); }
  [[nodiscard]] double mismatch() const { return worst_; }
  [[nodiscard]] int worst_bus() const { return worst_bus_; }

 private:
  [[nodiscard]] bool live(int i) const { return n_.buses[at(i)].type != BusType::isolated; }
  [[nodiscard]] Complex load(int i) const {
    const double vm = std::abs(v_[i]);
    return in_.power[at(i)] + vm * (in_.current[at(i)] + vm * in_.admittance[at(i)]);
  }
  /// Mismatches at the present voltages; false if they are not finite any more.
  bool evaluate() {
    i_ = y_ * v_;
    f_ = Eigen::VectorXd::Zero(unknowns_);
    double worst = 0.0;
    int bus = -1;
    for (int i = 0; i < v_.size(); ++i) {
      if (angle_[at(i)] < 0) continue;
      const Complex d = delivered(i) - in_.generation[at(i)];
      f_[angle_[at(i)]] = d.real();
      if (magnitude_[at(i)] >= 0) f_[magnitude_[at(i)]] = d.imag();
      const double size = std::max(std::abs(d.real()), magnitude_[at(i)] >= 0 ? std::abs(d.imag()) : 0.0);
      if (!std::isfinite(size)) return false;
      if (bus < 0 || size > worst) {
        worst = size;
        bus = i;
      }
    }
    worst_ = worst;
    worst_bus_ = bus;
    return true;
  }
  /// A mismatch below a few units in the last place of the powers that meet at the bus is rounding.
  [[nodiscard]] bool converged(double tolerance) const {
    Eigen::VectorXd meeting = Eigen::VectorXd::Zero(v_.size());
    for (int j = 0; j < y_.outerSize(); ++j)
      for (Eigen::SparseMatrix<Complex>::InnerIterator e(y_, j); e; ++e)
        meeting[e.row()] += std::abs(v_[e.row()]) * std::abs(e.value()) * std::abs(v_[j]);
    constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
    for (int i = 0; i < v_.size(); ++i)
      for (const int k : {angle_[at(i)], magnitude_[at(i)]})
        if (k >= 0 && std::abs(f_[k]) > std::max(tolerance, rounding * meeting[i])) return false;
    return true;
  }
  /// One Newton step with dS/d(angle) and dS/d|V|.
  bool step() {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int i, int column, Complex d) {
      if (column < 0) return;
      if (angle_[at(i)] >= 0) entries.emplace_back(angle_[at(i)], column, d.real());
      if (magnitude_[at(i)] >= 0) entries.emplace_back(magnitude_[at(i)], column, d.imag());
    };
    const Complex j1(0.0, 1.0);
    for (int j = 0; j < y_.outerSize(); ++j) {
      if (!live(j)) continue;
      for (Eigen::SparseMatrix<Complex>::InnerIterator e(y_, j); e; ++e) {
        const int i = static_cast<int>(e.row());
        const Complex flow = v_[i] * std::conj(e.value() * v_[j]);
        add(i, angle_[at(j)], -j1 * flow);
        add(i, magnitude_[at(j)], flow / std::abs(v_[j]));
      }
      const double vm = std::abs(v_[j]);
      const Complex own = v_[j] * std::conj(i_[j]);
      add(j, angle_[at(j)], j1 * own);
      add(j, magnitude_[at(j)], own / vm + in_.current[at(j)] + 2.0 * vm * in_.admittance[at(j)]);
    }
    Eigen::SparseMatrix<double> jacobian(unknowns_, unknowns_);
    jacobian.setFromTriplets(entries.begin(), entries.end());
    Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(jacobian);
    if (lu.info() != Eigen::Success) return false;
    const Eigen::VectorXd dx = lu.solve(f_);
    if (!dx.allFinite()) return false;
    for (int i = 0; i < v_.size(); ++i) {
      if (angle_[at(i)] < 0) continue;
      const double vm = std::abs(v_[i]) - (magnitude_[at(i)] >= 0 ? dx[magnitude_[at(i)]] : 0.0);
      v_[i] = (in_.held[at(i)] > 0.0 ? in_.held[at(i)] : vm) *
              std::polar(1.0, std::arg(v_[i]) - dx[angle_[at(i)]]);
    }
    return true;
  }

  const Network& n_;
  const Injections& in_;
  int slack_;
  Eigen::SparseMatrix<Complex> y_;
  std::vector<int> angle_, magnitude_;  ///< position of each bus's unknowns, or -1
  int unknowns_ = 0;
  Eigen::VectorXcd v_, i_;
  Eigen::VectorXd f_;
  double worst_ = 0.0;
  int worst_bus_ = -1;
};

}  // namespace

PowerFlow solve_power_flow(const Network& network, double tolerance, int limit) {
  const Injections in = collect(network);
  const int slack = check_slack(network, in);
  Newton newton(network, slack, in);
  PowerFlow flow;
  newton.start(false);
  if (!newton.iterate(tolerance, limit, flow.iterations)) {
    newton.start(true);  // a poor start in the file is no reason to give up
    if (!newton.iterate(tolerance, limit, flow.iterations)) {
      const double size = newton.mismatch();
      throw InputError({"the power flow diverges, worst at " + bus_list(network, {newton.worst_bus()}) +
                            " with a mismatch of " + std::to_string(size) + " pu (" +
                            std::to_string(size * network.base_mva) + " MVA)",
                        network.origin,
                        std::to_string(limit) +
                            " iterations from the file's voltages and from a flat start did not balance it",
                        "check loads, dispatch and impedances near that bus"});
    }
  }
  flow.mismatch = newton.mismatch();
  flow.voltage.assign(newton.voltage().begin(), newton.voltage().end());

  std::vector<double> mva(network.buses.size());
  for (const Generator& g : network.generators)
    if (g.in_service) mva[at(g.bus)] += g.mva;
  for (const Generator& g : network.generators) {
    Complex s{};
    if (g.in_service) {
      s = newton.delivered(g.bus) * (g.mva / mva[at(g.bus)]);
      if (g.bus != slack) s = {g.p, s.imag()};
    }
    flow.generation.push_back(s);
  }
  return flow;
}

}  // namespace swingbank::sim::network
