#pragma once
// Row products of I = (G + jB) E, for a separate matrix per lane or for a matrix that all lanes share.
#include "sim/batch/detail/low_rank.hpp"

namespace swingbank::sim::batch {

/// Computes one row of I for a separate matrix per lane.
template <class T>
inline void row_times(const T* g, const T* b, const T* er, const T* ei, int columns, T& ir, T& ii) {
  T gr = g[0] * er[0], gi = g[0] * ei[0], bi = b[0] * ei[0], br = b[0] * er[0];
  for (int j = 1; j < columns; ++j) {
    gr = gr + g[j] * er[j];
    gi = gi + g[j] * ei[j];
    bi = bi + b[j] * ei[j];
    br = br + b[j] * er[j];
  }
  ir = gr - bi;
  ii = gi + br;
}

/// Rows of a matrix that all lanes share. Several rows are multiplied together, so that E is loaded only once
/// for them.
class SharedRows {
 public:
#ifdef __AVX512F__
  static constexpr std::size_t kTogether = 4;
#else
  static constexpr std::size_t kTogether = 2;  ///< rows per product: four sums per row, in sixteen registers
#endif
  /// Returns the size of ir and ii that `times` requires for a number of rows.
  static std::size_t padded(std::size_t rows) { return (rows + kTogether - 1) / kTogether * kTogether; }

  /// Stores the given rows of matrix + more.
  void assign(const InternalMatrix& matrix, const std::vector<int>& rows, const LowRank& more = {}) {
    assign(
        matrix.grounded.size(), rows, [&](int row) { return matrix.row(row); }, more);
  }
  /// The same for a matrix with row access: row(k) returns a complex row.
  template <class RowOf>
  void assign(std::size_t columns, const std::vector<int>& rows, const RowOf& row, const LowRank& more) {
    columns_ = columns;
    values_.assign(padded(rows.size()) * columns_ * 2, 0.0);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto from = row(rows[k]);
      double* to = values_.data() + 2 * (k / kTogether * kTogether * columns_ + k % kTogether);
      for (std::size_t j = 0; j < columns_; ++j, to += 2 * kTogether) {
        const Complex m = from[static_cast<Eigen::Index>(j)];
        to[0] = m.real();
        to[1] = m.imag();
        for (std::size_t u = static_cast<std::size_t>(rows[k]), w = j; u < more.ur.size();
             u += columns_, w += columns_) {
          to[0] += more.ur[u] * more.wr[w] - more.ui[u] * more.wi[w];
          to[1] += more.ur[u] * more.wi[w] + more.ui[u] * more.wr[w];
        }
      }
    }
  }

  /// Computes I for every stored row.
  template <class T>
  void times(const T* er, const T* ei, T* ir, T* ii) const {
    const double* at = values_.data();
    for (const double* end = at + values_.size(); at != end; ir += kTogether, ii += kTogether) {
      T gr[kTogether], gi[kTogether], br[kTogether], bi[kTogether];
      for (std::size_t r = 0; r < kTogether; ++r) gr[r] = gi[r] = br[r] = bi[r] = T(0.0);
      for (std::size_t j = 0; j < columns_; ++j, at += 2 * kTogether) {
        const T real = er[j], imaginary = ei[j];
        for (std::size_t r = 0; r < kTogether; ++r) {
          const T g(at[2 * r]), b(at[2 * r + 1]);
          gr[r] = gr[r] + g * real;
          gi[r] = gi[r] + g * imaginary;
          br[r] = br[r] + b * real;
          bi[r] = bi[r] + b * imaginary;
        }
      }
      for (std::size_t r = 0; r < kTogether; ++r) {
        ir[r] = gr[r] - bi[r];
        ii[r] = gi[r] + br[r];
      }
    }
  }

 private:
  std::size_t columns_ = 0;
  std::vector<double> values_;  ///< [group of kTogether rows][column][row of the group]: g, b
};

}  // namespace swingbank::sim::batch
