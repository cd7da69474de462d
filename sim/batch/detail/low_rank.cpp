#include "sim/batch/detail/low_rank.hpp"

#include <algorithm>

namespace swingbank::sim::batch {

namespace {
constexpr double kSolveRounding =
    1e-13;  ///< rounding error of the matrices, as a fraction of the largest entry of `from`

double square(double a, double b) { return a * a + b * b; }

/// Remainder of the difference during the elimination.
struct Rest {
  std::size_t n;
  std::vector<double> g, b;

  /// Returns the index of the largest entry; sets `size` to its squared magnitude.
  [[nodiscard]] std::size_t largest(double& size) const {
    std::size_t at = 0;
    size = 0.0;
    for (std::size_t i = 0; i < g.size(); i += n) {
      double row = 0.0;
      for (std::size_t j = i; j < i + n; ++j) row = std::max(row, square(g[j], b[j]));
      if (row > size) size = row, at = i;
    }
    const std::size_t end = at + n;
    while (at + 1 < end && square(g[at], b[at]) < size) ++at;
    return at;
  }

  /// Moves one outer product from the remainder to `out`: the pivot's column, divided by the pivot, times the
  /// pivot's row.
  void eliminate(std::size_t pivot, LowRank& out) {
    const std::size_t row = pivot / n, column = pivot % n;
    const double scale = 1.0 / square(g[pivot], b[pivot]);
    const double pr = g[pivot] * scale, pi = -b[pivot] * scale;
    for (std::size_t i = 0; i < n; ++i) {
      const double r = g[i * n + column], x = b[i * n + column];
      out.add({r * pr - x * pi, r * pi + x * pr}, {g[row * n + i], b[row * n + i]});
    }
    const std::size_t of = static_cast<std::size_t>(out.rank++) * n;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        g[i * n + j] -= out.ur[of + i] * out.wr[of + j] - out.ui[of + i] * out.wi[of + j];
        b[i * n + j] -= out.ur[of + i] * out.wi[of + j] + out.ui[of + i] * out.wr[of + j];
      }
  }
};
}  // namespace

std::optional<LowRank> difference(const InternalMatrix& matrix, const InternalMatrix& from, int most) {
  double whole = 0.0;
  for (std::size_t i = 0; i < from.g.size(); ++i) whole = std::max(whole, square(from.g[i], from.b[i]));
  Rest rest{from.grounded.size(), matrix.g, matrix.b};
  for (std::size_t i = 0; i < from.g.size(); ++i) {
    rest.g[i] -= from.g[i];
    rest.b[i] -= from.b[i];
  }
  LowRank out;
  for (;;) {
    double size = 0.0;
    const std::size_t pivot = rest.largest(size);
    if (size <= kSolveRounding * kSolveRounding * whole) return out;
    if (out.rank == most) return {};
    rest.eliminate(pivot, out);
  }
}

void add_impedances(LowRank& products, const InternalMatrix& matrix,
                    const std::vector<ImpedanceChange>& changes) {
  add_impedances(products, {[&](int k) { return matrix.row(k); }, [&](int k) { return matrix.column(k); }},
                 changes);
}

void add_impedances(LowRank& products, const ByRowsAndColumns& matrix,
                    const std::vector<ImpedanceChange>& changes) {
  if (changes.empty()) return;
  const auto count = static_cast<Eigen::Index>(changes.size());
  const Eigen::Index n = matrix.row(changes[0].source).size();
  const auto factor = [n](const std::vector<double>& r, const std::vector<double>& i, Eigen::Index k,
                          Eigen::Index at) {
    const auto p = static_cast<std::size_t>(k * n + at);
    return Complex(r[p], i[p]);
  };
  Eigen::MatrixXcd columns(n, count), rows(count, n), a = Eigen::MatrixXcd::Identity(count, count);
  Eigen::VectorXcd dz(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto& [source, by] = changes[static_cast<std::size_t>(k)];
    dz[k] = by;
    columns.col(k) = matrix.column(source);
    rows.row(k) = matrix.row(source).transpose();
    for (Eigen::Index p = 0; p < products.rank; ++p) {
      const Complex u = factor(products.ur, products.ui, p, source),
                    w = factor(products.wr, products.wi, p, source);
      for (Eigen::Index i = 0; i < n; ++i) {
        columns(i, k) += factor(products.ur, products.ui, p, i) * w;
        rows(k, i) += u * factor(products.wr, products.wi, p, i);
      }
    }
    for (Eigen::Index j = 0; j < count; ++j)
      a(k, j) += by * rows(k, changes[static_cast<std::size_t>(j)].source);
  }
  const Eigen::MatrixXcd emf =
      a.partialPivLu().solve(Eigen::MatrixXcd(dz.asDiagonal()));  // equivalent change of the EMF
  const Eigen::MatrixXcd u = columns * -emf;
  for (Eigen::Index k = 0; k < count; ++k)
    for (Eigen::Index i = 0; i < n; ++i) products.add(u(i, k), rows(k, i));
  products.rank += static_cast<int>(count);
}

}  // namespace swingbank::sim::batch
