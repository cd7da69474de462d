#pragma once
// Small matrices in packs of eight columns, with one SIMD register per row of a pack: products and inverses.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "sim/core/scalar.hpp"

namespace swingbank::validate::playin::by_pack {

using sim::P8;
inline constexpr auto kLanes = std::size_t(P8::lanes);  ///< columns of a pack

/// A matrix stored by packs of eight columns, the rows of each pack contiguous.
class Matrix {
 public:
  Matrix(std::size_t rows, std::size_t columns)
      : rows_(rows), packs_((columns + kLanes - 1) / kLanes), all_(rows * packs_, P8(0.0)) {}
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t packs() const { return packs_; }
  P8* pack(std::size_t p) { return all_.data() + p * rows_; }
  [[nodiscard]] const P8* pack(std::size_t p) const { return all_.data() + p * rows_; }
  /// Returns the first element of a column; the element of the next row is kLanes doubles further.
  double* column(std::size_t j) { return reinterpret_cast<double*>(pack(j / kLanes)) + j % kLanes; }
  [[nodiscard]] const double* column(std::size_t j) const {
    return reinterpret_cast<const double*>(pack(j / kLanes)) + j % kLanes;
  }
  double& operator()(std::size_t i, std::size_t j) { return column(j)[i * kLanes]; }
  double operator()(std::size_t i, std::size_t j) const { return column(j)[i * kLanes]; }
  void clear(std::size_t p) { std::fill_n(pack(p), rows_, P8(0.0)); }

 private:
  std::size_t rows_, packs_;
  std::vector<P8> all_;
};

/// Adds the product `factors` * `from` to `count` rows of one pack, starting at row `first`. `inner`: number
/// of rows of `from`.
template <std::size_t count>
void add_rows(const Matrix& factors, std::size_t first, std::size_t inner, const P8* from, P8* to) {
  P8 sum[count];
#pragma GCC unroll 8
  for (std::size_t i = 0; i < count; ++i) sum[i] = to[first + i];
  for (std::size_t begin = 0; begin < inner; begin += kLanes) {
    const double* factor = factors.column(begin) + first * kLanes;
    for (std::size_t j = begin; j < std::min(inner, begin + kLanes); ++j, ++factor) {
      const P8 row = from[j];
#pragma GCC unroll 8
      for (std::size_t i = 0; i < count; ++i) sum[i] = sum[i] + P8(factor[i * kLanes]) * row;
    }
  }
#pragma GCC unroll 8
  for (std::size_t i = 0; i < count; ++i) to[first + i] = sum[i];
}
/// Computes `to` += `factors` * `from` for one pack of columns, starting at row i.
template <std::size_t count = sim::kRegisterBytes == 64 ? 8 : 4>  // sums of these rows stay in registers
void add_product(const Matrix& factors, std::size_t inner, const P8* from, P8* to, std::size_t i = 0) {
  for (; i + count <= factors.rows(); i += count) add_rows<count>(factors, i, inner, from, to);
  if constexpr (count > 1) add_product<count / 2>(factors, inner, from, to, i);
}
/// Computes inverse = left^-1 by Gauss-Jordan elimination with partial pivoting; left is overwritten.
inline void invert(Matrix& left, Matrix& inverse) {
  const std::size_t n = left.rows();
  for (std::size_t p = 0; p < inverse.packs(); ++p) inverse.clear(p);
  for (std::size_t i = 0; i < n; ++i) inverse(i, i) = 1.0;
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(left(i, k)) > std::abs(left(pivot, k))) pivot = i;
    if (pivot != k)
      for (Matrix* m : {&left, &inverse})
        for (std::size_t p = 0; p < m->packs(); ++p) std::swap(m->pack(p)[k], m->pack(p)[pivot]);
    const P8 per(1 / left(k, k));
    const double* factor = left.column(k);
    const auto eliminate = [&](P8* rows) {
      const P8 row = rows[k] * per;
      for (std::size_t i = 0; i < n; ++i)
        if (const double f = factor[i * kLanes]; f != 0.0) rows[i] = rows[i] - P8(f) * row;
      rows[k] = row;
    };
    for (std::size_t p = 0; p < inverse.packs(); ++p) eliminate(inverse.pack(p));
    for (std::size_t p = left.packs(); p-- > k / kLanes;)
      eliminate(left.pack(p));  // the pack that contains the factors comes last
  }
}

}  // namespace swingbank::validate::playin::by_pack
