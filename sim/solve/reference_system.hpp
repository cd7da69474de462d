#pragma once
// The unreduced differential-algebraic system of one topology, F(y, y') = 0 with
//   y = [ states of plant 0, plant 1, ... | Vr, Vi of bus 0, bus 1, ... ]
//   states:  x' - f(x, V) = 0
//   buses:   Y V - sum of the machines' currents = 0 [pu on base_mva];  V = 0 where the fault is bolted
// and its sparse Jacobian dF/dy + a dF/dy', plants by duals, network constant.
#include <Eigen/Sparse>
#include <array>
#include <span>
#include <vector>

#include "sim/network/event.hpp"
#include "sim/solve/grid.hpp"
#include "sim/solve/plant_equations.hpp"

namespace swingbank::sim {

/// What all topologies of one run share: plants at their operating points and where their states lie.
class ReferencePlants {
 public:
  struct Unit {
    const Plant* plant;
    Operating operating;
    PlantEquations<double> equations;
    PlantEquations<D8> sensitivities;
    int first;     ///< index of its first state
    int delta;     ///< index of its rotor angle among its own states, -1 if it has none
    Complex y;     ///< 1/(r + jx) [pu on the machine's base]
    double scale;  ///< machine base / network base
  };
  explicit ReferencePlants(const Grid& grid);
  [[nodiscard]] const std::vector<Unit>& units() const { return units_; }
  [[nodiscard]] int states() const { return states_; }
  /// EMF of one unit [pu] from the whole state vector.
  [[nodiscard]] Complex emf(const Unit& unit, const double* y) const;
  /// Every signal of one unit at terminal voltage v; dx (its states' derivatives) may be nullptr.
  [[nodiscard]] Signals<double> signals(const Unit& unit, const double* y, Complex v,
                                        double* dx = nullptr) const;

 private:
  std::vector<Unit> units_;
  int states_ = 0;
};

class ReferenceSystem {
 public:
  /// Throws InputError if a part of the grid is cut off without machine or fault.
  ReferenceSystem(const Grid& grid, const ReferencePlants& plants, const Topology& topology);
  [[nodiscard]] int size() const { return plants_.states() + 2 * buses_; }
  [[nodiscard]] bool bolted(int bus) const { return bolted_[static_cast<std::size_t>(bus)]; }

  /// Bus voltages that satisfy the algebraic equations for the states in y: written into y. Exact, since a
  /// machine's EMF depends on its states alone: (Y + sum y_machine) V = sum y_machine E.
  void solve_voltages(double* y) const;
  /// y' of the states; zero for the voltages.
  void derivatives(const double* y, double* yp) const;
  void residual(const double* y, const double* yp, double* f) const;

  /// Jacobian in compressed columns; the pattern is that of `pattern()`, values are written in its order.
  [[nodiscard]] const Eigen::SparseMatrix<double>& pattern() const { return constant_; }
  void jacobian(double a, const double* y, double* values) const;

 private:
  void build_network(const Grid& grid, const Topology& topology);
  void build_pattern();
  void plant_jacobian(std::size_t unit, double a, const double* y, double* values) const;
  [[nodiscard]] int bus_row(int bus) const { return plants_.states() + 2 * bus; }

  const ReferencePlants& plants_;
  int buses_;
  std::vector<bool> bolted_;
  Eigen::SparseMatrix<Complex, Eigen::RowMajor> y_;  ///< network; rows of bolted buses are empty
  Eigen::SparseMatrix<double> constant_;             ///< dF/dy of the network, with room for the plants
  std::vector<std::vector<int>> places_;  ///< [unit]: place of each (column, row) of its block, -1: none
};

}  // namespace swingbank::sim
