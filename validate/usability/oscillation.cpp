// Least damped oscillation of a simulated response, by the matrix pencil method.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.hpp"
#include "validate/usability/usability.hpp"

namespace swingbank::validate::usability {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Signals = std::vector<std::vector<double>>;

/// Largest ratio of the singular values that count as modes: three significant digits of the response (T. K.
/// Sarkar, O. Pereira, IEEE Antennas and Propagation Magazine 37 (1995) 48).
constexpr double kSignificant = 1e3;

/// Returns the Hankel matrices of the signals, one above the other.
MatrixXd hankel(const Signals& signals, Eigen::Index columns) {
  const auto samples = static_cast<Eigen::Index>(signals.front().size());
  const Eigen::Index rows = samples - columns + 1;
  MatrixXd all(rows * static_cast<Eigen::Index>(signals.size()), columns);
  for (std::size_t s = 0; s < signals.size(); ++s)
    for (Eigen::Index r = 0; r < rows; ++r)
      for (Eigen::Index c = 0; c < columns; ++c)
        all(static_cast<Eigen::Index>(s) * rows + r, c) = signals[s][static_cast<std::size_t>(r + c)];
  return all;
}

/// Returns the factors exp(eigenvalue / rate) of the signals' modes.
VectorXcd poles(const Signals& signals, double accuracy) {
  const auto samples = static_cast<Eigen::Index>(signals.front().size());
  const Eigen::Index columns = samples / 3 + 1;  // the pencil parameter with the least error: N/3 ... N/2
  const MatrixXd y = hankel(signals, columns);
  const Eigen::BDCSVD<MatrixXd> svd(y, Eigen::ComputeThinV);
  // Modes below the significant digits of the response only describe its errors and nonlinearity.
  const double errors = accuracy * std::sqrt(static_cast<double>(y.size()));
  const double least = std::max(errors, svd.singularValues()[0] / kSignificant);
  const Eigen::Index modes =
      std::min<Eigen::Index>((svd.singularValues().array() > least).count(), columns - 1);
  if (modes == 0) return {};
  const MatrixXd v = svd.matrixV().leftCols(modes);
  const MatrixXd shift = v.topRows(columns - 1).colPivHouseholderQr().solve(v.bottomRows(columns - 1));
  return Eigen::EigenSolver<MatrixXd>(shift, false).eigenvalues();
}

}  // namespace

std::optional<Oscillation> least_damped_oscillation(const Signals& signals, double rate, double accuracy) {
  if (signals.empty() || signals.front().empty()) return {};
  const VectorXcd z = poles(signals, accuracy);
  if (z.size() == 0) return {};
  const auto samples = static_cast<Eigen::Index>(signals.front().size());
  MatrixXcd powers(samples, z.size());  // powers of z: the modes' time series
  powers.row(0).setOnes();
  for (Eigen::Index k = 1; k < samples; ++k) powers.row(k) = powers.row(k - 1).cwiseProduct(z.transpose());
  MatrixXcd y(samples, static_cast<Eigen::Index>(signals.size()));
  for (std::size_t s = 0; s < signals.size(); ++s)
    y.col(static_cast<Eigen::Index>(s)) =
        Eigen::Map<const Eigen::VectorXd>(signals[s].data(), samples).cast<std::complex<double>>();
  const MatrixXcd residues = powers.colPivHouseholderQr().solve(y);
  const double rest = (y - powers * residues).squaredNorm();
  std::optional<Oscillation> least;
  for (Eigen::Index k = 0; k < z.size(); ++k) {
    if (!(z[k].imag() > 0)) continue;  // only one of each conjugate pair
    const double amplitude = 2 * residues.row(k).cwiseAbs().maxCoeff();
    const double energy = (2 * powers.col(k) * residues.row(k)).real().squaredNorm();
    if (!(amplitude > accuracy) || !(energy > rest)) continue;
    const std::complex<double> eigenvalue = std::log(z[k]) * rate;
    const double damping = -eigenvalue.real() / std::abs(eigenvalue);
    if (!least || damping < least->damping)
      least = Oscillation{eigenvalue.imag() / constants::turn, damping, amplitude};
  }
  return least;
}

}  // namespace swingbank::validate::usability
