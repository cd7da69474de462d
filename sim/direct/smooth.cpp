#include "sim/direct/smooth.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sim/direct/integral.hpp"

namespace swingbank::sim::direct {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns the smoothing matrix: row k is the value at sample k of the parabola fitted to `length`
/// neighbours.
MatrixXd parabola(Index length) {
  const Index terms = std::min<Index>(3, length);
  MatrixXd powers(length, terms);
  for (Index k = 0; k < length; ++k)
    for (Index j = 0; j < terms; ++j)
      powers(k, j) = std::pow(static_cast<double>(2 * k - length + 1) / static_cast<double>(length), j);
  const MatrixXd q = powers.householderQr().householderQ() * MatrixXd::Identity(length, terms);
  return q * q.transpose();
}

void smooth(Eigen::Ref<VectorXd> x, Index window) {
  const Index length = std::min(window, x.size());
  const MatrixXd by = parabola(length);
  const VectorXd noisy = x;
  for (Index k = 0; k < x.size(); ++k) {
    const Index first = std::clamp<Index>(k - length / 2, 0, x.size() - length);
    x[k] = by.row(k - first).dot(noisy.segment(first, length));
  }
}

}  // namespace

Recording smoothed(Recording record) {
  constexpr double kSmoothing = 0.2;  // length of a parabola [s]
  const auto window = std::max<Index>(3, std::lround(kSmoothing / record.step));
  const double limit = leap_limit(record);
  const std::size_t steady = record.event > 0
                                 ? static_cast<std::size_t>(record.event / record.step + 1e-6) + 1
                                 : before_first_leap(record);
  std::vector<std::size_t> edges = {std::min(steady, record.V.size())};
  for (std::size_t k = edges[0] + 1; k < record.V.size(); ++k)
    if (std::abs(record.V[k] - record.V[k - 1]) > limit) edges.push_back(k);
  edges.push_back(record.V.size());
  for (auto* x : {&record.V, &record.theta, &record.P, &record.Q, &record.speed, &record.Ifd}) {
    if (x->empty()) continue;
    Eigen::Map<VectorXd> all(x->data(), static_cast<Index>(x->size()));
    const auto before = static_cast<Index>(edges[0]);
    // The last of the `before` samples may be at the event's time, with the value before or after the step.
    if (before > 1) all.head(before).setConstant(all.head(before - 1).mean());
    for (std::size_t k = 0; k + 1 < edges.size(); ++k)
      if (edges[k + 1] > edges[k])
        smooth(all.segment(static_cast<Index>(edges[k]), static_cast<Index>(edges[k + 1] - edges[k])),
               window);
  }
  return record;
}

}  // namespace swingbank::sim::direct
