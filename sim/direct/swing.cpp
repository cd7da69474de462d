#include "sim/direct/swing.hpp"

#include <Eigen/Dense>

#include "sim/direct/detail/turning.hpp"
#include "sim/direct/integral.hpp"

namespace swingbank::sim::direct {

Swing swing_of(const Recording& record, double Ra, Divided divided) {
  const std::size_t first = behind_last_leap(record);
  if (first + kShortestStretch > record.V.size()) return {};
  const Turning t = turning(record, Ra, 0.0, first, record.V.size());
  const Conventions& by = record.conventions;
  const Eigen::ArrayXd slip = t.speed.array();
  const Eigen::ArrayXd driving = 1 / (1 + (by.mechanical_power ? 1.0 : 0.0) * slip);
  Eigen::ArrayXd electrical = t.P.array();
  if (divided == Divided::all)
    electrical *= driving;
  else if (by.speed_voltage)
    electrical /= 1 + slip;
  Eigen::VectorXd torque = integral((t.P0 * driving - electrical).matrix(), t.step);
  torque.array() -= torque.mean();
  // Means over all samples are subtracted, so that no single sample serves as reference.
  Eigen::MatrixX2d columns(slip.size(), 2);
  columns.col(0) = t.speed;
  columns.col(1) = integral((slip * driving).matrix(), t.step);
  columns.rowwise() -= columns.colwise().mean().eval();
  const Eigen::RowVector2d size = columns.colwise().norm().cwiseMax(1e-300);
  columns.array().rowwise() /= size.array();
  const Eigen::Vector2d x = columns.colPivHouseholderQr().solve(torque);
  return {x[0] / size[0] / 2, x[1] / size[1], (torque - columns * x).norm() / (torque.norm() + 1e-300)};
}

}  // namespace swingbank::sim::direct
