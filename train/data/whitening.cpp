#include "train/data/whitening.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/problem.hpp"
#include "base/sealed_file.hpp"
#include "train/data/regressions.hpp"
#include "train/data/split.hpp"

namespace swingbank::train::data {
namespace {

using Eigen::Index;
constexpr std::size_t kRowsToFit = 8000;  ///< about fifteen times the number of fitted components
/// Distance between the 10 % and 90 % quantiles of a normal distribution, in standard deviations.
constexpr float kMiddleInDeviations = 2.56f;
constexpr float kStillRow = 1e-6f;    ///< added to a row's size, which is 0 for a constant row [pu]
constexpr double kRank = 1e-9;        ///< relative variance up to which a component is rounding error
constexpr double kSmallLevel = 1e-4;  ///< noise level of the fit; the noise is proportional to its level
constexpr float kWidestCoefficient = 4.0f;  ///< limit of a coefficient's deviation from its median, in widths
/// Limit of a row's noise, as a multiple of the median: a low voltage near a fault amplifies the noise.
constexpr float kLongestNoise = 3.0f;

using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Moments {
  Eigen::RowVectorXd mean;
  Eigen::MatrixXd covariance;
};
template <class M>
Moments moments(const M& x) {
  const Eigen::MatrixXd wide = x.template cast<double>();
  const Eigen::RowVectorXd mean = wide.colwise().mean();
  const Eigen::MatrixXd from = wide.rowwise() - mean;
  return {mean, from.transpose() * from / static_cast<double>(x.rows())};
}

std::vector<float> flat(const float* values, Index count) { return {values, values + count}; }

}  // namespace

Whitening Whitening::fit(const ShardStream& stream, std::span<const std::uint64_t> rows,
                         std::size_t components) {
  const InputSelection& s = stream.selection();
  if (components == 0 || components > s.samples)
    throw InputError({fmt::format("{} components of {} samples", components, s.samples), "pca_components",
                      "the number must be between 1 and the number of samples",
                      "choose a number in this range"});
  Whitening w;
  w.sizes_ = {s.outputs(),
              s.samples,
              s.levels(),
              components,
              0,
              s.shows_level ? 1u : 0u,
              s.regressions ? regression_count(s.outputs()) : 0};
  const std::vector<std::uint64_t> some = some_of(rows, kRowsToFit);
  Rows series(static_cast<Index>(some.size()), static_cast<Index>(s.values()));
  stream.read(some, series.data(), s.shows_level ? Noise{0.0} : stream.judged());
  w.fit_bases(series);
  w.fit_whole(w.components(series.data(), some.size()));
  if (s.regressions) w.fit_regressions(series, s.physics->bin_samples());
  if (!s.shows_level) return w;
  Rows noisy(series.rows(), series.cols());
  stream.read(some, noisy.data(), Noise{kSmallLevel, 1});
  w.fit_noise(series, noisy);
  return w;
}

void Whitening::fit_bases(const Rows& series) {
  const auto n = static_cast<Index>(sizes_.samples), k = static_cast<Index>(sizes_.components);
  const Eigen::ArrayXf size =
      (series.leftCols(n).rowwise().squaredNorm() / static_cast<float>(n)).cwiseSqrt().array() + kStillRow;
  for (Index c = 0; c < static_cast<Index>(sizes_.channels); ++c) {
    const Rows own = (series.middleCols(c * n, n).array().colwise() / size).matrix();
    const Moments m = moments(own);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(m.covariance);
    mean_.push_back(m.mean.cast<float>());
    basis_.push_back(solver.eigenvectors().rightCols(k).rowwise().reverse().cast<float>());
  }
}

void Whitening::fit_whole(const Rows& components) {
  centre_ = components.cast<double>().colwise().mean().cast<float>();
  const Rows from = components.rowwise() - centre_;
  unit_ = (from.cast<double>().colwise().squaredNorm() / static_cast<double>(from.rows()))
              .cwiseSqrt()
              .cast<float>();
  for (float& u : unit_)
    if (u == 0.0f) u = 1.0f;
  const Rows scaled = (from.array().rowwise() / unit_.array()).matrix();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(moments(scaled).covariance);
  const Eigen::VectorXd variance = solver.eigenvalues();
  Index dropped = 0;
  while (variance[dropped] <= kRank * variance[variance.size() - 1]) ++dropped;
  const Index kept = variance.size() - dropped;
  sizes_.kept = static_cast<std::size_t>(kept);
  const Eigen::VectorXd shrink = variance.tail(kept).cwiseSqrt().cwiseInverse();
  whole_ = (solver.eigenvectors().rightCols(kept) * shrink.asDiagonal()).cast<float>();
}

Rows Whitening::whitened(const Rows& components) const {
  return ((components.rowwise() - centre_).array().rowwise() / unit_.array()).matrix() * whole_;
}

void Whitening::fit_regressions(const Rows& series, std::vector<float> weights) {
  weights_ = std::move(weights);
  const std::size_t count = sizes_.regressed, rows = static_cast<std::size_t>(series.rows());
  std::vector<float> all(rows * count), own(rows);
  for (std::size_t i = 0; i < rows; ++i)
    regress(series.row(static_cast<Index>(i)).data(), sizes_.channels, weights_, all.data() + i * count);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < rows; ++i) own[i] = all[i * count + k];
    std::ranges::sort(own);
    const float low = own[rows / 10], high = own[rows - 1 - rows / 10];
    median_.push_back(own[rows / 2]);
    width_.push_back(high > low ? (high - low) / kMiddleInDeviations : 1.0f);
  }
}

void Whitening::apply_regressions(const float* series, float* out) const {
  regress(series, sizes_.channels, weights_, out);
  for (std::size_t k = 0; k < sizes_.regressed; ++k)
    out[k] = std::clamp((out[k] - median_[k]) / width_[k], -kWidestCoefficient, kWidestCoefficient);
}

void Whitening::fit_noise(const Rows& clean, const Rows& noisy) {
  const auto count = static_cast<std::size_t>(clean.rows());
  const Rows before = components(clean.data(), count), after = components(noisy.data(), count);
  Rows noise = whitened(after) - whitened(before);
  const Eigen::ArrayXf over = before.rightCols(1).array().exp() / static_cast<float>(kSmallLevel);
  noise.array().colwise() *= over;
  std::vector<float> length(count);
  for (Index i = 0; i < noise.rows(); ++i) length[static_cast<std::size_t>(i)] = noise.row(i).norm();
  std::vector<float> sorted = length;
  std::ranges::sort(sorted);
  const float longest = kLongestNoise * sorted[count / 2];
  for (Index i = 0; i < noise.rows(); ++i)
    noise.row(i) *= std::min(1.0f, longest / std::max(longest * 1e-6f, length[static_cast<std::size_t>(i)]));
  const Eigen::MatrixXd wide = noise.cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(wide.transpose() * wide /
                                                              static_cast<double>(count));
  whole_ = whole_ * solver.eigenvectors().cast<float>();
  noise_ = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().cast<float>().transpose();
}

Rows Whitening::components(const float* series, std::size_t count) const {
  const auto n = static_cast<Index>(sizes_.samples), channels = static_cast<Index>(sizes_.channels),
             k = static_cast<Index>(sizes_.components), levels = static_cast<Index>(sizes_.levels);
  const auto noisy = static_cast<Index>(sizes_.noisy);
  const Eigen::Map<const Rows> all(series, static_cast<Index>(count), channels * n + levels + noisy);
  const Eigen::ArrayXf size =
      (all.leftCols(n).rowwise().squaredNorm() / static_cast<float>(n)).cwiseSqrt().array() + kStillRow;
  Rows out(all.rows(), channels * k + levels + 1);
  Rows own(all.rows(), n);
  for (Index c = 0; c < channels; ++c) {
    const auto at = static_cast<std::size_t>(c);
    own = ((all.middleCols(c * n, n).array().colwise() / size).matrix()).rowwise() - mean_[at];
    out.middleCols(c * k, k).noalias() = own * basis_[at];
  }
  out.middleCols(channels * k, levels) = all.middleCols(channels * n, levels);
  out.rightCols(1) = size.log().matrix();
  return out;
}

void Whitening::apply(const float* series, std::size_t count, float* out) const {
  const Rows parts = components(series, count);
  const Rows all = ((parts.rowwise() - centre_).array().rowwise() / unit_.array()).matrix();
  Eigen::Map<Rows> row(out, static_cast<Index>(count), static_cast<Index>(length()));
  const auto kept = static_cast<Index>(sizes_.kept), behind = static_cast<Index>(sizes_.levels + 1);
  row.leftCols(kept).noalias() = all * whole_;
  row.middleCols(kept, behind) = all.rightCols(behind);
  if (sizes_.noisy > 0) {
    const std::size_t values = sizes_.channels * sizes_.samples + sizes_.levels + 1;
    for (Index i = 0; i < row.rows(); ++i) {
      const float noise_input = series[static_cast<std::size_t>(i + 1) * values - 1];
      // Wiener filter: expected value of a signal of variance 1 that is observed with noise of standard
      // deviation level x noise_.
      const auto level =
          static_cast<float>(level_of_input(noise_input)) / std::exp(parts(i, parts.cols() - 1));
      row.row(i).head(kept).array() /= 1.0f + (level * noise_.array()).square();
      row(i, kept + behind) = noise_input;
    }
  }
  const auto bounded = static_cast<Index>(length() - sizes_.regressed);
  // asinh reduces values far outside the range of the training rows
  row.leftCols(bounded) = row.leftCols(bounded).unaryExpr([](float v) { return std::asinh(v); });
  if (sizes_.regressed == 0) return;
  const auto values =
      static_cast<std::size_t>(sizes_.channels * sizes_.samples + sizes_.levels + sizes_.noisy);
  for (Index i = 0; i < row.rows(); ++i)
    apply_regressions(series + static_cast<std::size_t>(i) * values, row.row(i).data() + bounded);
}

std::vector<std::vector<float>> Whitening::arrays() const {
  std::vector<std::vector<float>> all;
  for (std::size_t c = 0; c < mean_.size(); ++c) {
    all.push_back(flat(mean_[c].data(), mean_[c].size()));
    all.push_back(flat(basis_[c].data(), basis_[c].size()));
  }
  all.push_back(flat(centre_.data(), centre_.size()));
  all.push_back(flat(unit_.data(), unit_.size()));
  all.push_back(flat(whole_.data(), whole_.size()));
  if (sizes_.noisy > 0) all.push_back(flat(noise_.data(), noise_.size()));
  if (sizes_.regressed > 0) all.insert(all.end(), {weights_, median_, width_});
  return all;
}

Whitening Whitening::restore(const WhiteningSizes& sizes, std::span<const std::vector<float>> arrays) {
  Whitening w;
  w.sizes_ = sizes;
  const auto n = static_cast<Index>(sizes.samples), k = static_cast<Index>(sizes.components);
  const auto all = static_cast<Index>(sizes.channels * sizes.components + sizes.levels + 1);
  const auto checked = [&](std::size_t i, Index length) {
    if (arrays[i].size() != static_cast<std::size_t>(length))
      throw Unusable{"the length of an array differs"};
    return arrays[i].data();
  };
  if (arrays.size() != array_count(sizes)) throw Unusable{"its number of arrays differs"};
  for (std::size_t c = 0; c < sizes.channels; ++c) {
    w.mean_.emplace_back(Eigen::Map<const Eigen::RowVectorXf>(checked(2 * c, n), n));
    w.basis_.emplace_back(Eigen::Map<const Eigen::MatrixXf>(checked(2 * c + 1, n * k), n, k));
  }
  const std::size_t last = 2 * sizes.channels;
  const auto kept = static_cast<Index>(sizes.kept);
  w.centre_ = Eigen::Map<const Eigen::RowVectorXf>(checked(last, all), all);
  w.unit_ = Eigen::Map<const Eigen::RowVectorXf>(checked(last + 1, all), all);
  w.whole_ = Eigen::Map<const Eigen::MatrixXf>(checked(last + 2, all * kept), all, kept);
  if (sizes.noisy > 0) w.noise_ = Eigen::Map<const Eigen::RowVectorXf>(checked(last + 3, kept), kept);
  if (sizes.regressed == 0) return w;
  const auto copied = [&](std::size_t i, std::size_t length) {
    const float* first = checked(last + 3 + sizes.noisy + i, static_cast<Index>(length));
    return std::vector<float>(first, first + length);
  };
  w.weights_ = copied(0, sizes.samples);
  w.median_ = copied(1, sizes.regressed);
  w.width_ = copied(2, sizes.regressed);
  return w;
}

}  // namespace swingbank::train::data
