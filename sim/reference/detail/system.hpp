#pragma once
// The unreduced differential-algebraic system of one segment. It is F(t, y, y') = 0 with
//   y = [ states of plant 0, plant 1, ..., load 0, ... | Vr, Vi of bus 0, bus 1, ... ]
//   states:  x' - f(t, x, V) = 0
//   buses:   Y V - sum of the units' currents = 0 [pu on base_mva];  V = 0 where the fault is bolted
//          or a trip has cut the bus off
// and its sparse Jacobian dF/dy + a dF/dy', units by duals, network constant.
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

/// What all segments of one run share: plants and modelled loads at their operating points and where their
/// states lie.
class ReferencePlants {
 public:
  struct Unit {
    const plant::Plant* plant = nullptr;  ///< or
    const plant::Consumer* load = nullptr;
    plant::Operating operating;
    std::vector<D8> coefficients;
    std::optional<plant::PlantEquations<double>> equations;
    std::optional<plant::PlantEquations<D8>> sensitivities;
    std::optional<plant::LoadEquations<double>> consumption;
    std::optional<plant::LoadEquations<D8>> consumption_sensitivities;
    int bus;
    /// Buses beside its own whose voltages it sees: the one that it regulates, the ends of the branch whose
    /// flow its plant's control counts.
    std::vector<int> seen;
    network::BranchEnd flow{};  ///< of that branch, from the last two of these
    int kind;                   ///< the same for units made of the same effects
    int first, states;          ///< index of its first state, and how many
    int delta;                  ///< index of its rotor angle among its own states, -1 if it has none
    double scale;               ///< own base / network base
    /// Unknowns of its block: states, Vr, Vi, those of the buses that it sees.
    [[nodiscard]] int members() const { return states + 2 + 2 * static_cast<int>(seen.size()); }
  };
  explicit ReferencePlants(const grid::Grid& grid);
  [[nodiscard]] const std::vector<Unit>& units() const { return units_; }  ///< plants, then loads
  [[nodiscard]] int states() const { return states_; }
  /// Further instants at which a segment must begin: the plants' effects jump there [s].
  [[nodiscard]] const std::vector<double>& instants() const { return instants_; }

 private:
  std::vector<Unit> units_;
  std::vector<double> instants_;
  int states_ = 0;
};

class ReferenceSystem {
 public:
  using Unit = ReferencePlants::Unit;
  /// `end`: until when the segment lasts [s]; effects never see a later time. Throws InputError if a part of
  /// the grid has converters and no machine or fault.
  ReferenceSystem(const grid::Grid& grid, const ReferencePlants& plants, const network::Segment& segment,
                  double end);
  [[nodiscard]] int size() const { return plants_.states() + 2 * buses_; }
  [[nodiscard]] int states() const { return plants_.states(); }  ///< they stand before the voltages
  [[nodiscard]] const std::vector<Unit>& units() const { return plants_.units(); }
  [[nodiscard]] bool bolted(int bus) const { return bolted_[static_cast<std::size_t>(bus)]; }
  /// Number of the island that a bus lies in.
  [[nodiscard]] int island(int bus) const { return island_[static_cast<std::size_t>(bus)]; }
  [[nodiscard]] bool tripped(std::size_t unit) const { return connected_[unit] == 0.0; }
  /// Part of a unit that is connected, 0 to 1.
  [[nodiscard]] double connected(std::size_t unit) const { return connected_[unit]; }

  /// Bus voltages that satisfy the algebraic equations for the states in y: written into y, which holds the
  /// ones to start from (Newton). Where there are none near these, those found from zero: a current that is
  /// given beside a fault has no others (decision 37). False if there are none.
  bool search_voltages(double t, double* y) const;
  /// The same; throws InputError if there are none.
  void solve_voltages(double t, double* y) const;
  /// y' of the states; zero for the voltages.
  void derivatives(double t, const double* y, double* yp) const;
  void residual(double t, const double* y, const double* yp, double* f) const;
  /// Per unknown: what its error counts in step control. States of stabilisers and exciters stand before
  /// gains of some thousands and some ten, and before limits that turn a late state into a lasting error of
  /// Efd; those of machines behind an Efd that such a limit bends at once.
  [[nodiscard]] std::vector<double> error_weights() const;
  /// Takes states back to the limits they have crossed; true if any moved.
  bool clamp_states(double* y) const;
  /// Every signal of one unit, current into the grid in `current`; dx (its states' derivatives) may be
  /// nullptr.
  Signals<double> signals(std::size_t unit, double t, const double* y, Complex& current,
                          double* dx = nullptr) const;

  /// Jacobian in compressed columns; the pattern is that of `pattern()`, values are written in its order.
  [[nodiscard]] const Eigen::SparseMatrix<double>& pattern() const { return constant_; }
  void jacobian(double t, double a, const double* y, double* values) const;
  /// Of a unit's block, column by column (states, Vr, Vi, those of the buses that it sees): where each
  /// entry stands in the pattern, -1: nowhere.
  [[nodiscard]] const std::vector<int>& places(std::size_t unit) const { return places_[unit]; }

 private:
  bool newton(double t, double* y) const;
  void build_network(const grid::Grid& grid, const network::Topology& topology);
  using Rows = Eigen::SparseMatrix<Complex, Eigen::RowMajor>;
  void build_pattern(const Rows& y);
  void tie_current(const network::Tie& tie, const double* y, double* f) const;
  void unit_jacobian(std::size_t unit, double t, double a, const double* y, double* values) const;
  /// Room for one evaluation: m of a plant's equations, a unit's unknowns and derivatives.
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
  double last_moment_;  ///< largest time effects may see [s]
  std::vector<bool> bolted_;
  std::vector<int> open_;                    ///< branches that carry nothing, sorted
  std::vector<int> island_;                  ///< per bus
  std::vector<double> connected_;            ///< per unit: part that is connected
  std::vector<network::Setpoint> setpoint_;  ///< per unit
  Rows y_;                                   ///< network without its ties; rows of bolted buses are empty
  std::vector<network::Tie> ties_;
  Eigen::SparseMatrix<double> constant_;  ///< dF/dy of the network, with room for the units
  std::vector<std::vector<int>> places_;  ///< [unit]: place of each (column, row) of its block, -1: none
  mutable Scratch<double> scratch_;       ///< a system serves one thread
  mutable Scratch<D8> dual_scratch_;
};

}  // namespace swingbank::sim::reference
