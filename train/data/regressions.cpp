#include "train/data/regressions.hpp"

#include <Eigen/Dense>

namespace swingbank::train::data {
namespace {
constexpr double kApart = 1e-12;  ///< ridge, relative to a signal's mean square
constexpr double kStill = 1e-24;  ///< ridge for a constant signal [pu^2]
}  // namespace

void regress(const float* series, std::size_t signals, std::span<const float> weights, float* out) {
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto n = static_cast<Eigen::Index>(signals), samples = static_cast<Eigen::Index>(weights.size());
  const Eigen::ArrayXd weight =
      Eigen::Map<const Eigen::ArrayXf>(weights.data(), samples).cast<double>() /
      Eigen::Map<const Eigen::ArrayXf>(weights.data(), samples).cast<double>().sum();
  Eigen::MatrixXd x = Eigen::Map<const Rows>(series, n, samples).cast<double>();
  x.colwise() -= (x * weight.matrix()).eval();
  const Eigen::MatrixXd square = x * weight.matrix().asDiagonal() * x.transpose();
  for (Eigen::Index y = 0; y < n; ++y)
    for (Eigen::Index a = 0; a < n; ++a)
      for (Eigen::Index b = a + 1; b < n; ++b) {
        if (a == y || b == y) continue;
        const double aa = square(a, a) * (1 + kApart) + kStill, bb = square(b, b) * (1 + kApart) + kStill,
                     ab = square(a, b), determinant = aa * bb - ab * ab;
        *out++ = static_cast<float>((bb * square(a, y) - ab * square(b, y)) / determinant);
        *out++ = static_cast<float>((aa * square(b, y) - ab * square(a, y)) / determinant);
      }
}

}  // namespace swingbank::train::data
