#pragma once
// Whitening of noise that has a memory: noise of the played-in voltage passes regulator and rotor, and what
// comes out is slow. The filter predicts each sample of the residual from those before it; what it does not
// predict, the innovation, is white (Kalman, J. Basic Eng. 82, 1960; correlated disturbances as in Anderson
// and Moore, Optimal Filtering, 1979, section 5.4).
#include <Eigen/Dense>
#include <vector>

namespace swingbank::validate::event {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// x[k+1] = A x[k] + w, e[k] = C x[k] + v. The covariance of w is Q, that of v is S, that of w with v is M,
/// and that of x[0] is P. Behind sample k, the covariance of w is larger by `doubtful[k]` times `jump`
/// (empty: nowhere).
struct SlowNoise {
  Eigen::MatrixXd A, C, Q, S, M, P, jump = {};
  std::vector<char> doubtful = {};
};

class Innovations {
 public:
  /// Filters `samples` samples of a record; those marked in `left_out` (empty: none) are not compared.
  Innovations(const SlowNoise& noise, int samples, const std::vector<char>& left_out);
  /// Whitens every column of e [compared sample * channels + channel][column] in place.
  void whiten(RowMatrix& e) const;

 private:
  struct Step {
    bool compared;
    Eigen::MatrixXd white;  ///< inverse root of the innovation's covariance, lower triangular
    Eigen::MatrixXd gain;   ///< gain by which the innovation corrects the prediction
  };
  Eigen::MatrixXd A_, C_;
  std::vector<Step> steps_;
};

}  // namespace swingbank::validate::event
