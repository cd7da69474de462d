#include "validate/playin/allowance.hpp"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

namespace swingbank::validate::playin {

std::vector<double> allowances(const LinearPlant& plant, std::span<const Output> compared, double interval) {
  constexpr double kUnseen = 1e-6;  // the factor stays 1 below this influence, which a limit may have delayed
  constexpr int kDoublings = 8;     // influences are evaluated up to 2^8 samples later
  const Eigen::Index n = plant.A.rows();
  std::vector<double> all(static_cast<std::size_t>(n), 1.0);
  if (compared.empty() || !plant.A.allFinite() || !plant.C.allFinite()) return all;
  Eigen::MatrixXd shown(static_cast<Eigen::Index>(compared.size()), n);
  for (std::size_t c = 0; c < compared.size(); ++c)
    shown.row(static_cast<Eigen::Index>(c)) = plant.C.row(static_cast<Eigen::Index>(compared[c]));
  Eigen::VectorXd most = shown.cwiseAbs().colwise().maxCoeff();
  Eigen::MatrixXd later = (interval * plant.A).exp();
  for (int k = 0; k <= kDoublings && later.allFinite(); ++k) {
    most = most.cwiseMax((shown * later).cwiseAbs().colwise().maxCoeff().transpose());
    later = (later * later).eval();
  }
  for (Eigen::Index i = 0; i < n; ++i)
    if (most[i] > kUnseen) all[static_cast<std::size_t>(i)] = std::clamp(1 / most[i], 1.0, kMostAllowance);
  return all;
}

}  // namespace swingbank::validate::playin
