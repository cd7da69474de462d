#pragma once
// Sparse triangular factors of the bus admittance matrix, for grids of many sources: computes the bus
// voltages from the injected currents, for all lanes at once.
#include <Eigen/SparseCore>
#include <vector>

#include "sim/network/powerflow.hpp"

namespace swingbank::sim::batch {

/// LDU factors of a bus admittance matrix in the elimination order.
class BusFactors {
 public:
  using Sparse = Eigen::SparseMatrix<Complex>;
  /// Factorises without pivoting. Admittance matrices that include the machines' own admittances seldom need
  /// pivoting. Returns false if this matrix needs it.
  bool factor(const Sparse& admittance);
  [[nodiscard]] std::size_t buses() const { return inverse_.size(); }
  [[nodiscard]] std::size_t entries() const { return lower_.entries.size() + upper_.entries.size(); }
  /// Returns the position of a bus in the arrays of currents and voltages.
  [[nodiscard]] int place(int bus) const { return place_[static_cast<std::size_t>(bus)]; }
  /// Replaces the injected currents by the bus voltages, in place.
  template <class T>
  void solve(T* real, T* imaginary) const;

 private:
  struct Entry {
    int column;
    double r, i;
  };
  /// One triangular factor, row by row.
  struct Triangle {
    std::vector<std::size_t> first{0};
    std::vector<Entry> entries;
    void end_row() { first.push_back(entries.size()); }
  };
  bool eliminate(const Sparse& admittance);
  void by_height();
  template <class T>
  static void take_off(const Triangle& triangle, std::size_t row, T* real, T* imaginary);

  std::vector<int> order_, place_;  ///< bus eliminated k-th; inverse permutation of order_
  Triangle lower_, upper_;          ///< upper: divided by the row's pivot
  std::vector<Complex> inverse_;    ///< reciprocal pivots
};

template <class T>
inline void BusFactors::take_off(const Triangle& triangle, std::size_t row, T* real, T* imaginary) {
  T rr = real[row], ri = imaginary[row], ir(0.0), ii(0.0);
  for (std::size_t k = triangle.first[row]; k < triangle.first[row + 1]; ++k) {
    const Entry& e = triangle.entries[k];
    const T r(e.r), i(e.i);
    const T& vr = real[e.column];
    const T& vi = imaginary[e.column];
    rr = rr - r * vr;
    ri = ri - r * vi;
    ir = ir + i * vr;
    ii = ii + i * vi;
  }
  real[row] = rr + ii;
  imaginary[row] = ri - ir;
}

template <class T>
inline void BusFactors::solve(T* real, T* imaginary) const {
  const std::size_t n = buses();
  for (std::size_t i = 0; i < n; ++i) take_off(lower_, i, real, imaginary);
  for (std::size_t i = 0; i < n; ++i) {
    const T a(inverse_[i].real()), b(inverse_[i].imag()), r = real[i];
    real[i] = a * r - b * imaginary[i];
    imaginary[i] = a * imaginary[i] + b * r;
  }
  for (std::size_t i = n; i-- > 0;) take_off(upper_, i, real, imaginary);
}

}  // namespace swingbank::sim::batch
