#pragma once
// Low-rank update of the reduced network for a switching, in grids of many sources. A switching affects few
// buses, and one factorisation of the whole network gives the response to currents into these buses.
#include <Eigen/SparseLU>

#include "sim/batch/detail/low_rank.hpp"

namespace swingbank::sim::batch {

/// Bus of a plant, and the plant's admittance on the network's base (`source`) and on its own base (`own`)
/// [pu].
struct Feed {
  int bus;
  Complex source, own;
};

/// Factorised network of a grid, for the low-rank updates of switchings.
class SwitchedNetwork {
 public:
  using Sparse = Eigen::SparseMatrix<Complex>;
  /// r, x: impedance per plant [pu on its own base]. Every load must be a constant impedance.
  SwitchedNetwork(const grid::Grid& grid, const std::vector<double>& r, const std::vector<double>& x);
  /// Returns the change of the matrix relative to the unswitched network, with at most `most` products.
  /// Returns none if a generator is tripped, entirely or in part, if more than `most` buses are affected, if
  /// the network could not be factorised, or if the switched network is ill-conditioned. InternalNetwork then
  /// computes the matrix.
  [[nodiscard]] std::optional<LowRank> change(const network::Topology& topology, int most) const;

  /// Returns true if the network could be factorised; only then row() and column() of the unswitched reduced
  /// matrix are available.
  [[nodiscard]] bool sound() const { return sound_; }
  [[nodiscard]] Eigen::VectorXcd row(int plant) const;
  [[nodiscard]] Eigen::VectorXcd column(int plant) const;
  [[nodiscard]] const std::vector<Feed>& plants() const { return plants_; }
  /// Returns the bus admittance matrix without switching, including the machines' admittances.
  [[nodiscard]] const Sparse& closed() const { return closed_; }

 private:
  struct Touched {
    std::vector<int> buses;
    Eigen::MatrixXcd admittance;  ///< added admittance between these buses
    Eigen::MatrixXcd voltage;  ///< voltages of all buses (rows) per unit current into these buses (columns)
  };
  [[nodiscard]] std::optional<Touched> touch(const network::Topology& topology, int most) const;
  [[nodiscard]] std::optional<Eigen::MatrixXcd> currents(const Touched& touched,
                                                         const std::vector<int>& bolted) const;
  [[nodiscard]] Eigen::MatrixXcd unit_currents(const std::vector<int>& buses) const;

  const grid::Grid& grid_;
  Sparse own_, closed_;  ///< bus admittance matrix without and with the machines' admittances
  Eigen::SparseLU<Sparse> factors_, transposed_;
  std::vector<Feed> plants_;
  bool sound_ = false;
};

}  // namespace swingbank::sim::batch
