#pragma once
// What a switching changes in the reduced network of many sources, without reducing it anew: the buses it
// touches are few, and what their currents do everywhere follows from one factorisation of the whole network.
#include <Eigen/SparseLU>

#include "sim/lanes/detail/low_rank.hpp"

namespace swingbank::sim::lanes {

/// How a plant feeds its bus: its admittance on the network's base, on its own.
struct Feed {
  int bus;
  Complex source, own;
};

class SwitchedNetwork {
 public:
  using Sparse = Eigen::SparseMatrix<Complex>;
  /// r, x: impedance per plant [pu on its own base]. Every load a constant impedance.
  SwitchedNetwork(const grid::Grid& grid, const std::vector<double>& r, const std::vector<double>& x);
  /// Against the network without any switching: at most `most` products. None where a generator is lost, more
  /// buses are touched, or what is left hangs together too loosely for it: InternalNetwork has the matrix.
  [[nodiscard]] std::optional<LowRank> change(const network::Topology& topology, int most) const;

  /// Whether the network could be factored: then row and column give those of the reduced matrix without
  /// switching.
  [[nodiscard]] bool sound() const { return sound_; }
  [[nodiscard]] Eigen::VectorXcd row(int plant) const;
  [[nodiscard]] Eigen::VectorXcd column(int plant) const;
  [[nodiscard]] const std::vector<Feed>& plants() const { return plants_; }
  /// Bus admittances without any switching, with the machines' own.
  [[nodiscard]] const Sparse& closed() const { return closed_; }

 private:
  struct Touched {
    std::vector<int> buses;
    Eigen::MatrixXcd admittance;  ///< what is added between them
    Eigen::MatrixXcd voltage;     ///< per unit of current into them: rows all buses
  };
  [[nodiscard]] std::optional<Touched> touch(const network::Topology& topology, int most) const;
  [[nodiscard]] std::optional<Eigen::MatrixXcd> currents(const Touched& touched,
                                                         const std::vector<int>& bolted) const;
  [[nodiscard]] Eigen::MatrixXcd unit_currents(const std::vector<int>& buses) const;

  const grid::Grid& grid_;
  Sparse own_, closed_;  ///< bus admittances; with the machines'
  Eigen::SparseLU<Sparse> factors_, transposed_;
  std::vector<Feed> plants_;
  bool sound_ = false;
};

}  // namespace swingbank::sim::lanes
