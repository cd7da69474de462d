#include "validate/noise/innovations.hpp"

namespace swingbank::validate::noise {

Innovations::Innovations(const SlowNoise& noise, int samples, const std::vector<char>& left_out)
    : A_(noise.A), C_(noise.C) {
  const Eigen::Index n = C_.rows();
  Eigen::MatrixXd P = noise.P;
  for (int k = 0; k < samples; ++k) {
    Eigen::MatrixXd next = A_ * P * A_.transpose() + noise.Q;
    if (!noise.doubtful.empty()) next += noise.doubtful[static_cast<std::size_t>(k)] * noise.added_covariance;
    Step step{left_out.empty() || !left_out[static_cast<std::size_t>(k)], {}, {}};
    if (step.compared) {
      const Eigen::MatrixXd S = C_ * P * C_.transpose() + noise.S;
      const Eigen::MatrixXd cross = A_ * P * C_.transpose() + noise.M;
      const auto factor = S.llt();
      step.white = factor.matrixL().solve(Eigen::MatrixXd::Identity(n, n));
      step.gain = factor.solve(cross.transpose()).transpose();
      next -= step.gain * cross.transpose();
    }
    P = 0.5 * (next + next.transpose());
    steps_.push_back(std::move(step));
  }
}

void Innovations::whiten(RowMatrix& e) const {
  const Eigen::Index n = C_.rows();
  RowMatrix x = RowMatrix::Zero(A_.rows(), e.cols()), next = x, seen(n, e.cols());
  Eigen::Index row = 0;
  for (const Step& step : steps_) {
    next.noalias() = A_ * x;
    if (step.compared) {
      auto block = e.middleRows(row, n);
      seen = block;
      seen.noalias() -= C_ * x;
      next.noalias() += step.gain * seen;
      block.noalias() = step.white * seen;
      row += n;
    }
    x.swap(next);
  }
}

}  // namespace swingbank::validate::noise
