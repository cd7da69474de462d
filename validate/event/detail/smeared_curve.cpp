#include "validate/event/detail/smeared_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace swingbank::validate::event {
namespace {

constexpr double kAnyVoltage = 3;  ///< standard deviation of a coefficient, where nothing else is known [pu]

/// Cubic B-splines on a uniform grid, those that reach a span, at u = 0 ... 1 of it.
std::array<double, 4> cubics(double u) {
  const double a = 1 - u;
  return {a * a * a / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * a * a * a - 6 * a * a + 4) / 6,
          u * u * u / 6};
}
/// Integral of the products of their second derivatives over a span of length 1.
const Eigen::Matrix4d& bends() {
  static const Eigen::Matrix4d product = [] {
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    for (const double u : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
      const Eigen::Vector4d bend(1 - u, 3 * u - 2, 1 - 3 * u, u);
      sum += 0.5 * bend * bend.transpose();
    }
    return sum;
  }();
  return product;
}

}  // namespace

SmearedCurve::SmearedCurve(const SmearedStretch& stretch, const FilterWindow& window,
                           std::vector<double> instants, double roughness) {
  set_segments(stretch, window, instants);
  const auto samples = static_cast<Eigen::Index>(stretch.t.size());
  Eigen::MatrixXd measured(samples, 2);
  for (Eigen::Index k = 0; k < samples; ++k) {
    const Complex v = stretch.v[static_cast<std::size_t>(k)];
    measured.row(k) << v.real(), v.imag();
  }
  const double weight = 1 / (stretch.noise * stretch.noise);
  const Eigen::MatrixXd A = averages(stretch, window), before = prior(roughness);
  precision_.compute(before + weight * A.transpose() * A);
  coefficients_ = precision_.solve(weight * A.transpose() * measured);
  const double missed = weight * (measured - A * coefficients_).squaredNorm();
  const double unlikely = (coefficients_.transpose() * before * coefficients_).trace();
  const auto log_root = [](const Eigen::LLT<Eigen::MatrixXd>& L) {
    return L.matrixLLT().diagonal().array().log().sum();
  };
  // two components share the matrices
  evidence_ = -0.5 * (missed + unlikely) + 2 * (log_root(before.llt()) - log_root(precision_)) -
              2 * static_cast<double>(samples) * std::log(stretch.noise);
}

void SmearedCurve::set_segments(const SmearedStretch& stretch, const FilterWindow& window,
                                const std::vector<double>& instants) {
  const double aim = std::max(stretch.step / 2, window.half() / 8);
  double from = stretch.t.front() - window.half();
  const auto add = [&](double to) {
    const int spans = std::max(1, static_cast<int>(std::ceil((to - from) / aim)));
    segments_.push_back({from, (to - from) / spans, spans, count_});
    count_ += spans + 3;
    from = to;
  };
  for (const double instant : instants) add(instant);
  add(stretch.t.back() + window.half());
}

Eigen::MatrixXd SmearedCurve::averages(const SmearedStretch& stretch, const FilterWindow& window) const {
  constexpr std::array<std::pair<double, double>, 4> kGauss = {{{0.0694318442029737, 0.1739274225687269},
                                                                {0.3300094782075719, 0.3260725774312731},
                                                                {0.6699905217924281, 0.3260725774312731},
                                                                {0.9305681557970263, 0.1739274225687269}}};
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(stretch.t.size()), count_);
  for (Eigen::Index k = 0; k < A.rows(); ++k) {
    const double at = stretch.t[static_cast<std::size_t>(k)], half = window.half();
    const auto add = [&](const Segment& s, int span, double from, double to) {
      for (const auto& [place, share] : kGauss) {
        const double t = from + (to - from) * place, w = window(t - at) * (to - from) * share;
        const auto shape = cubics((t - s.from) / s.span - span);
        for (int j = 0; j < 4; ++j) A(k, s.first + span + j) += w * shape[static_cast<std::size_t>(j)];
      }
    };
    for (const Segment& s : segments_) {
      const auto index = [&](double t) {
        return std::clamp(static_cast<int>((t - s.from) / s.span), 0, s.spans - 1);
      };
      if (at + half <= s.from || at - half >= s.from + s.spans * s.span) continue;
      for (int span = index(at - half); span <= index(at + half); ++span) {
        const double from = std::max(s.from + span * s.span, at - half);
        const double to = std::min(s.from + (span + 1) * s.span, at + half);
        if (from < at && at < to) {  // a triangle has a corner there
          add(s, span, from, at);
          add(s, span, at, to);
        } else if (from < to) {
          add(s, span, from, to);
        }
      }
    }
  }
  return A;
}

Eigen::MatrixXd SmearedCurve::prior(double roughness) const {
  Eigen::MatrixXd P = Eigen::MatrixXd::Identity(count_, count_) / (kAnyVoltage * kAnyVoltage);
  for (const Segment& s : segments_)
    for (int span = 0; span < s.spans; ++span)
      P.block<4, 4>(s.first + span, s.first + span) += bends() / (roughness * s.span * s.span * s.span);
  return P;
}

Eigen::VectorXd SmearedCurve::basis(int segment, double t) const {
  const Segment& s = segments_[static_cast<std::size_t>(segment)];
  const int span = std::clamp(static_cast<int>((t - s.from) / s.span), 0, s.spans - 1);
  const auto shape = cubics((t - s.from) / s.span - span);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(count_);
  for (int j = 0; j < 4; ++j) b[s.first + span + j] = shape[static_cast<std::size_t>(j)];
  return b;
}

Complex SmearedCurve::operator()(int segment, double t) const {
  const Eigen::RowVector2d v = basis(segment, t).transpose() * coefficients_;
  return {v[0], v[1]};
}

double SmearedCurve::deviation(int segment, double t) const {
  return precision_.matrixL().solve(basis(segment, t)).norm();
}

}  // namespace swingbank::validate::event
