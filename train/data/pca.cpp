#include "train/data/pca.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/problem.hpp"
#include "base/sealed_file.hpp"

namespace swingbank::train::data {
namespace {

/// First and second moments of the one-second segments of a channel, in double precision.
struct SecondMoments {
  Eigen::VectorXd sum;
  Eigen::MatrixXd square;
  double count = 0.0;
};

void check_shape(double rate, std::size_t samples, std::size_t components) {
  const auto per_second = static_cast<std::size_t>(std::lround(rate));
  Problems problems;
  if (std::abs(rate - static_cast<double>(per_second)) > 1e-9)
    problems.add(fmt::format("{} samples per second", rate), "slice",
                 "PCA needs an integer number of samples per second", "choose a slice that divides the rate");
  else if (per_second == 0 || samples % per_second != 0)
    problems.add(fmt::format("a window of {} samples at {}/s", samples, per_second), "start_s, end_s",
                 "PCA needs an integer number of seconds", "make the window a whole number of seconds");
  else if (components > per_second)
    problems.add(fmt::format("{} components of {} samples", components, per_second), "pca_components",
                 "there cannot be more components than samples in a second", "lower pca_components or slice");
  problems.raise();
}

std::vector<SecondMoments> second_moments(const ShardStream& stream, std::span<const std::uint64_t> rows,
                                          std::size_t per_second) {
  const std::size_t channels = stream.channels(), samples = stream.samples();
  std::vector<SecondMoments> all(channels);
  for (auto& m : all) {
    m.sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(per_second));
    m.square = Eigen::MatrixXd::Zero(m.sum.size(), m.sum.size());
  }
  constexpr std::size_t kRows = 1024;
  std::vector<float> series(kRows * stream.selection().values());
  for (std::size_t begin = 0; begin < rows.size(); begin += kRows) {
    const std::size_t count = std::min(kRows, rows.size() - begin);
    stream.read(rows.subspan(begin, count), series.data());
    for (std::size_t c = 0; c < channels; ++c)
      for (std::size_t r = 0; r < count; ++r) {
        const auto seconds =
            Eigen::Map<const Eigen::MatrixXf>(series.data() + (r * channels + c) * samples,
                                              static_cast<Eigen::Index>(per_second),
                                              static_cast<Eigen::Index>(samples / per_second))
                .cast<double>()
                .eval();
        all[c].sum += seconds.rowwise().sum();
        all[c].square.noalias() += seconds * seconds.transpose();
        all[c].count += static_cast<double>(seconds.cols());
      }
  }
  return all;
}

}  // namespace

Pca Pca::fit(const ShardStream& stream, std::span<const std::uint64_t> rows, std::size_t components) {
  check_shape(stream.selection().rate, stream.samples(), components);
  Pca pca;
  pca.components_ = components;
  pca.per_second_ = static_cast<std::size_t>(std::lround(stream.selection().rate));
  pca.seconds_ = stream.samples() / pca.per_second_;
  for (const auto& m : second_moments(stream, rows, pca.per_second_)) {
    const Eigen::VectorXd mean = m.sum / m.count;
    const Eigen::MatrixXd covariance = m.square / m.count - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    // Eigenvalues are in ascending order, so the leading components are the last columns.
    const auto k = static_cast<Eigen::Index>(components);
    pca.basis_.push_back(solver.eigenvectors().rightCols(k).rowwise().reverse().cast<float>());
    pca.mean_.push_back(mean.cast<float>());
    const double total = covariance.trace(), kept = solver.eigenvalues().tail(k).sum();
    if (total > 0.0) pca.error_ = std::max(pca.error_, std::max(0.0, 1.0 - kept / total));
  }
  return pca;
}

std::vector<std::vector<float>> Pca::arrays() const {
  std::vector<std::vector<float>> all;
  for (std::size_t c = 0; c < mean_.size(); ++c) {
    all.emplace_back(mean_[c].data(), mean_[c].data() + mean_[c].size());
    all.emplace_back(basis_[c].data(), basis_[c].data() + basis_[c].size());
  }
  return all;
}

Pca Pca::restore(std::size_t components, std::size_t per_second, std::size_t samples,
                 std::span<const std::vector<float>> arrays) {
  if (per_second == 0 || samples % per_second != 0)
    throw Unusable{"its length is not a whole number of seconds"};
  Pca pca;
  pca.components_ = components;
  pca.per_second_ = per_second;
  pca.seconds_ = samples / per_second;
  const auto rows = static_cast<Eigen::Index>(per_second), columns = static_cast<Eigen::Index>(components);
  for (std::size_t i = 0; i + 1 < arrays.size(); i += 2) {
    if (arrays[i].size() != per_second || arrays[i + 1].size() != per_second * components)
      throw Unusable{"the length of an array differs"};
    pca.mean_.push_back(Eigen::Map<const Eigen::VectorXf>(arrays[i].data(), rows));
    pca.basis_.push_back(Eigen::Map<const Eigen::MatrixXf>(arrays[i + 1].data(), rows, columns));
  }
  return pca;
}

void Pca::apply(const float* series, float* out) const {
  const auto samples = static_cast<Eigen::Index>(per_second_), seconds = static_cast<Eigen::Index>(seconds_);
  for (std::size_t c = 0; c < basis_.size(); ++c) {
    const Eigen::Map<const Eigen::MatrixXf> in(series + c * per_second_ * seconds_, samples, seconds);
    Eigen::Map<Eigen::MatrixXf> scores(out + c * length(), static_cast<Eigen::Index>(components_), seconds);
    scores.noalias() = basis_[c].transpose() * (in.colwise() - mean_[c]);
  }
}

void Pca::reconstruct(const float* components, float* series) const {
  const auto samples = static_cast<Eigen::Index>(per_second_), seconds = static_cast<Eigen::Index>(seconds_);
  for (std::size_t c = 0; c < basis_.size(); ++c) {
    const Eigen::Map<const Eigen::MatrixXf> scores(components + c * length(),
                                                   static_cast<Eigen::Index>(components_), seconds);
    Eigen::Map<Eigen::MatrixXf> out(series + c * per_second_ * seconds_, samples, seconds);
    out = (basis_[c] * scores).colwise() + mean_[c];
  }
}

}  // namespace swingbank::train::data
