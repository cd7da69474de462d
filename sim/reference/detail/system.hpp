#pragma once
// Unreduced differential-algebraic system of one segment. It is F(t, y, y') = 0 with
//   y = [ states of plant 0, plant 1, ..., load 0, ... | Vr, Vi of bus 0, bus 1, ... ]
//   states:  x' - f(t, x, V) = 0
//   buses:   Y V - sum of the units' currents = 0 [pu on base_mva];  V = 0 at bolted faults and at buses
//            disconnected by a trip
// The sparse Jacobian is dF/dy + a dF/dy': duals for the units, a constant matrix for the network.
#include <Eigen/Sparse>
#include <optional>
#include <vector>

#include "sim/grid/grid.hpp"
#include "sim/network/admittance.hpp"
#include "sim/network/event.hpp"
#include "sim/network/tie.hpp"
#include "sim/plant/equations.hpp"
#include "sim/plant/load_equations.hpp"

namespace swingbank::sim::reference {

/// Data common to all segments of a run: plants and modelled loads at their operating points, and the
/// positions of their states.
class ReferencePlants {
 public:
  struct Unit {
    const plant::Plant* plant = nullptr;    ///< the plant; null: the unit is a load
    const plant::Consumer* load = nullptr;  ///< the load; null: the unit is a plant
    plant::Operating operating;
    std::vector<D8> coefficients;
    std::optional<plant::PlantEquations<double>> equations;
    std::optional<plant::PlantEquations<D8>> sensitivities;
    std::optional<plant::LoadEquations<double>> consumption;
    std::optional<plant::LoadEquations<D8>> consumption_sensitivities;
    int bus;
    /// Remote buses whose voltages the unit needs: the regulated bus, then both ends of the measured branch.
    std::vector<int> seen;
    network::BranchEnd flow{};  ///< measured end of the branch, whose buses are the last two of `seen`
    int kind;                   ///< equal for units with the same effects and number of remote buses
    int first, states;          ///< index of its first state; number of states
    int delta;                  ///< index of its rotor angle in its own states, -1 if none
    double scale;               ///< MVA base of the unit divided by that of the network
    /// Returns the number of unknowns of its block: states, Vr, Vi, and those of the remote buses.
    [[nodiscard]] int members() const { return states + 2 + 2 * static_cast<int>(seen.size()); }
  };
  explicit ReferencePlants(const grid::Grid& grid);
  [[nodiscard]] const std::vector<Unit>& units() const { return units_; }  ///< plants, then loads
  [[nodiscard]] int states() const { return states_; }
  /// Further switching times, at which effects of the plants change in a step [s].
  [[nodiscard]] const std::vector<double>& switching_times() const { return switching_times_; }

 private:
  std::vector<Unit> units_;
  std::vector<double> switching_times_;
  int states_ = 0;
};

class ReferenceSystem {
 public:
  using Unit = ReferencePlants::Unit;
  /// `end`: end of the segment [s]; effects are never evaluated at a later time. Throws InputError if an
  /// island has converters but neither machine nor fault.
  ReferenceSystem(const grid::Grid& grid, const ReferencePlants& plants, const network::Segment& segment,
                  double end);
  [[nodiscard]] int size() const { return plants_.states() + 2 * buses_; }
  [[nodiscard]] int states() const { return plants_.states(); }  ///< they precede the voltages
  [[nodiscard]] const std::vector<Unit>& units() const { return plants_.units(); }
  [[nodiscard]] bool bolted(int bus) const { return bolted_[static_cast<std::size_t>(bus)]; }
  /// Returns the number of the bus's island.
  [[nodiscard]] int island(int bus) const { return island_[static_cast<std::size_t>(bus)]; }
  [[nodiscard]] bool tripped(std::size_t unit) const { return connected_[unit] == 0.0; }
  /// Returns the connected fraction of a unit, 0 to 1.
  [[nodiscard]] double connected(std::size_t unit) const { return connected_[unit]; }

  /// Solves the algebraic equations for the bus voltages by Newton's method, with the states and start
  /// voltages in y. If that fails, restarts from 0 and then from 1 pu, because a converter near a fault may
  /// have several voltage solutions (decision 37). Returns false if no start succeeds.
  bool search_voltages(double t, double* y) const;
  /// As search_voltages(), but throws InputError if no solution is found.
  void solve_voltages(double t, double* y) const;
  /// Computes y' of the states; zero for the voltages.
  void derivatives(double t, const double* y, double* yp) const;
  void residual(double t, const double* y, const double* yp, double* f) const;
  /// Returns the weight of each unknown's error in step control. States of stabilisers and exciters are
  /// multiplied by gains of ten to several thousand, and a small error of them at a limit can become a
  /// lasting error of Efd. States of machines follow an Efd that such a limit changes abruptly.
  [[nodiscard]] std::vector<double> error_weights() const;
  /// Clamps states to limits that they crossed. Returns true if any changed.
  bool clamp_states(double* y) const;
  /// Returns every signal of one unit and the current into the grid in `current`. `dx` receives its states'
  /// derivatives, if not nullptr.
  Signals<double> signals(std::size_t unit, double t, const double* y, Complex& current,
                          double* dx = nullptr) const;

  /// Returns the Jacobian's pattern in compressed columns; jacobian() writes `values` in its order.
  [[nodiscard]] const Eigen::SparseMatrix<double>& pattern() const { return constant_; }
  void jacobian(double t, double a, const double* y, double* values) const;
  /// Returns the position in the pattern of each entry of a unit's block, column by column; -1: none. Rows
  /// and columns are the unit's states, Vr, Vi, and Vr, Vi of the remote buses.
  [[nodiscard]] const std::vector<int>& places(std::size_t unit) const { return places_[unit]; }

 private:
  bool newton(double t, double* y) const;
  void build_network(const grid::Grid& grid, const network::Topology& topology);
  using Rows = Eigen::SparseMatrix<Complex, Eigen::RowMajor>;
  void build_pattern(const Rows& y);
  void tie_current(const network::Tie& tie, const double* y, double* f) const;
  void unit_jacobian(std::size_t unit, double t, double a, const double* y, double* values) const;
  /// Scratch memory of one evaluation: m of a plant's equations, a unit's unknowns and derivatives.
  template <class T>
  struct Scratch {
    std::vector<T> m, x, dx;
  };
  template <class T>
  Scratch<T>& scratch() const {
    if constexpr (std::is_same_v<T, double>)
      return scratch_;
    else
      return dual_scratch_;
  }
  template <class T>
  Signals<T> evaluate(std::size_t unit, double t, const T* x, const T* v, const T* seen, T* dx, T& ir,
                      T& ii) const;
  template <class T>
  void look_far(const Unit& unit, const T* seen, Signals<T>& s) const;
  [[nodiscard]] int bus_row(int bus) const { return plants_.states() + 2 * bus; }

  const ReferencePlants& plants_;
  int buses_;
  double last_moment_;  ///< latest time that effects may use [s]
  std::vector<bool> bolted_;
  std::vector<int> open_;                    ///< indices of the open branches, sorted
  std::vector<int> island_;                  ///< island of each bus
  std::vector<double> connected_;            ///< connected fraction of each unit, 0 to 1
  std::vector<network::Setpoint> setpoint_;  ///< set-point changes of each unit
  Rows y_;                                   ///< network without ties; rows of bolted buses are empty
  std::vector<network::Tie> ties_;
  Eigen::SparseMatrix<double> constant_;  ///< dF/dy of the network, with zero entries for the units
  std::vector<std::vector<int>> places_;  ///< [unit]: position of each (column, row) of its block, -1: none
  mutable Scratch<double> scratch_;       ///< a system is used by one thread
  mutable Scratch<D8> dual_scratch_;
};

}  // namespace swingbank::sim::reference
