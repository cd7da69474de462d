#pragma once
// PSS/E's network solution, as inferred from its records. Converters and loads other than admittances are
// current injections, a converter's in parallel with its source impedance (ZSORCE of the .raw). These
// currents, with the part of the source impedance, use the voltage of the previous solution; the remaining
// network is linear. Solutions are repeated until no voltage changes by more than the run's tolerance. From
// one step to the next, voltages mostly change by less than this tolerance, so a converter's source lags by
// one step.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <vector>

#include "sim/reference/detail/system.hpp"

namespace swingbank::sim::test {

/// Largest change of a voltage at the last solution, an option of a PSS/E run [pu]: the value for records
/// that do not reveal it, and that inferred from one converter behind two lines.
constexpr double kToTheEnd = 1e-6, kOfOneConverter = 1e-4;

class PsseNetwork {
 public:
  PsseNetwork(const grid::Grid& grid, const reference::ReferenceSystem& system, double tolerance)
      : system_(system), tolerance_(tolerance), first_(static_cast<std::size_t>(system.states())) {
    for (std::size_t u = 0; u < system.units().size(); ++u) {
      const auto& unit = system.units()[u];
      if (system.tripped(u) || system.bolted(unit.bus)) continue;
      if (unit.load)
        given_.push_back({u, unit.scale, 0.0});
      else if (unit.plant->machine.effect->converter)
        given_.push_back({u, unit.scale * system.connected(u), source(grid, unit) * system.connected(u)});
    }
    find_matrix(grid);
  }
  /// Updates the voltages in y by PSS/E's method, starting from the stored ones.
  void solve(double t, std::vector<double>& y) const {
    constexpr int kMost = 100;
    for (int k = 0; k < kMost; ++k)
      if (once(t, y) < tolerance_) return;
    throw std::runtime_error("PSS/E's network solution does not end");
  }

 private:
  /// Unit with given current: ratio of its base to the network's, and its source admittance [pu on base_mva].
  struct Given {
    std::size_t unit;
    double scale;
    Complex admittance;
  };
  static Complex source(const grid::Grid& grid, const reference::ReferencePlants::Unit& unit) {
    const auto& g = grid.network.generators.at(static_cast<std::size_t>(unit.plant->generator));
    return unit.scale / Complex(g.zr, g.zx);
  }
  [[nodiscard]] Complex voltage(const std::vector<double>& y, const Given& g) const {
    const std::size_t at = first_ + 2 * static_cast<std::size_t>(system_.units()[g.unit].bus);
    return {y[at], y[at + 1]};
  }
  [[nodiscard]] Complex current(double t, const std::vector<double>& y, const Given& g) const {
    Complex own;
    (void)system_.signals(g.unit, t, y.data(), own);
    return own * g.scale;
  }
  /// Current mismatch at every bus for the sources `from` of the given units.
  [[nodiscard]] Eigen::VectorXd missing(double t, const std::vector<double>& y,
                                        const std::vector<Complex>& from) const {
    std::vector<double> f(y.size());
    const std::vector<double> still(y.size(), 0.0);
    system_.residual(t, y.data(), still.data(), f.data());
    for (std::size_t i = 0; i < given_.size(); ++i) {
      const Given& g = given_[i];
      const Complex more = current(t, y, g) - (from[i] - g.admittance * voltage(y, g));
      const std::size_t at = first_ + 2 * static_cast<std::size_t>(system_.units()[g.unit].bus);
      f[at] += more.real();
      f[at + 1] += more.imag();
    }
    return Eigen::Map<const Eigen::VectorXd>(f.data() + first_, static_cast<Eigen::Index>(f.size() - first_));
  }
  [[nodiscard]] std::vector<Complex> sources(double t, const std::vector<double>& y) const {
    std::vector<Complex> from;
    for (const Given& g : given_) from.push_back(current(t, y, g) + g.admittance * voltage(y, g));
    return from;
  }
  /// Matrix of the network without its sources, which is linear; one column per voltage.
  void find_matrix(const grid::Grid& grid) {
    constexpr double kMove = 1e-3;
    std::vector<double> y(static_cast<std::size_t>(system_.size()));
    for (const auto& unit : system_.units())
      std::copy(unit.operating.x.begin(), unit.operating.x.end(), y.begin() + unit.first);
    for (std::size_t b = 0; b < grid.flow.voltage.size(); ++b) {
      y[first_ + 2 * b] = grid.flow.voltage[b].real();
      y[first_ + 2 * b + 1] = grid.flow.voltage[b].imag();
    }
    const auto from = sources(0.0, y);
    const Eigen::VectorXd f = missing(0.0, y, from);
    Eigen::MatrixXd matrix(f.size(), f.size());
    for (Eigen::Index i = 0; i < f.size(); ++i) {
      auto moved = y;
      moved[first_ + static_cast<std::size_t>(i)] += kMove;
      matrix.col(i) = (missing(0.0, moved, from) - f) / kMove;
    }
    matrix_ = matrix.partialPivLu();
  }
  /// Computes one solution. Returns the largest change of a voltage, as a complex number [pu].
  double once(double t, std::vector<double>& y) const {
    constexpr double kSolved = 1e-12;  // [pu]
    constexpr int kMost = 50;
    const auto from = sources(t, y);
    const auto before = y;
    double step = 1.0;
    for (int k = 0; step > kSolved; ++k) {
      if (k == kMost) throw std::runtime_error("the network beside its sources has no solution");
      const Eigen::VectorXd move = matrix_.solve(missing(t, y, from));
      for (Eigen::Index i = 0; i < move.size(); ++i) y[first_ + static_cast<std::size_t>(i)] -= move[i];
      step = move.cwiseAbs().maxCoeff();
    }
    double largest = 0.0;
    for (std::size_t i = first_; i < y.size(); i += 2)
      largest = std::max(largest, std::hypot(y[i] - before[i], y[i + 1] - before[i + 1]));
    return largest;
  }

  const reference::ReferenceSystem& system_;
  double tolerance_;
  std::size_t first_;  ///< index of the first voltage
  std::vector<Given> given_;
  Eigen::PartialPivLU<Eigen::MatrixXd> matrix_;
};

}  // namespace swingbank::sim::test
