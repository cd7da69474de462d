#pragma once
// Whitening of coloured noise, such as voltage noise after low-pass filtering by regulator and rotor. A
// Kalman filter predicts each sample of the residual from the earlier ones; the prediction errors
// (innovations) are white (Kalman, J. Basic Eng. 82, 1960; correlated disturbances as in Anderson and Moore,
// Optimal Filtering, 1979, section 5.4).
#include <Eigen/Dense>
#include <vector>

namespace swingbank::validate::noise {

/// Dense matrix, row by row in memory.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// State-space model of coloured noise: \f$x_{k+1} = A x_k + w\f$, \f$e_k = C x_k + v\f$. Covariances: Q of
/// w, S of v, M of w with v, P of x[0]. After sample k, the covariance of w is increased by `doubtful[k]`
/// times `added_covariance` (empty: nowhere).
struct SlowNoise {
  Eigen::MatrixXd A, C, Q, S, M, P, added_covariance = {};
  ///< system matrices and covariances, see above
  std::vector<char> doubtful = {};  ///< [sample]: multiple of `added_covariance`
};

/// Kalman filter that whitens coloured noise: its normalised innovations have unit variance.
class Innovations {
 public:
  /// Runs the filter over `samples` samples of a record; those marked in `left_out` (empty: none) are not
  /// compared.
  Innovations(const SlowNoise& noise, int samples, const std::vector<char>& left_out);
  /// Whitens every column of e [compared sample * channels + channel][column] in place.
  void whiten(RowMatrix& e) const;

 private:
  struct Step {
    bool compared;
    Eigen::MatrixXd white;  ///< inverse square root of the innovation's covariance, lower triangular
    Eigen::MatrixXd gain;   ///< Kalman gain of the innovation
  };
  Eigen::MatrixXd A_, C_;
  std::vector<Step> steps_;
};

}  // namespace swingbank::validate::noise
