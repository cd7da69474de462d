#include "validate/switching/detail/reconstructed_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace swingbank::validate::switching {
namespace {

constexpr double kAnyVoltage = 1;  ///< prior standard deviation of a coefficient about 0 [pu]

double square(double x) { return x * x; }
/// Returns the values, at u = 0 ... 1 in a span, of the four cubic B-splines that are non-zero there (uniform
/// grid).
std::array<double, 4> cubics(double u) {
  const double a = 1 - u;
  return {a * a * a / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * a * a * a - 6 * a * a + 4) / 6,
          u * u * u / 6};
}
/// Returns the integrals of the products of the B-splines' second derivatives over a span of length 1.
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

ReconstructedCurve::ReconstructedCurve(const FilteredSamples& stretch, const FilterWindow& window,
                                       const std::vector<double>& switching_times, double roughness) {
  set_segments(stretch, window, switching_times);
  const Eigen::MatrixXd A = averages(stretch, window);
  const Eigen::Index samples = A.rows();
  // The covariance of the samples [real parts, imaginary parts] is factorised, because it is a smaller matrix
  // than the precision of the coefficients. Noise has components along and across the phasor.
  Eigen::MatrixXd roots(count_, samples), covariance = Eigen::MatrixXd::Zero(2 * samples, 2 * samples);
  std::vector<Eigen::LLT<Eigen::MatrixXd>> priors;
  for (const Segment& s : segments_) {
    priors.emplace_back(prior(s, roughness));
    const Eigen::Index size = s.spans + 3;
    roots.middleRows(s.first, size) = priors.back().matrixL().solve(A.middleCols(s.first, size).transpose());
  }
  covariance.topLeftCorner(samples, samples).selfadjointView<Eigen::Lower>().rankUpdate(roots.transpose());
  covariance.bottomRightCorner(samples, samples) = covariance.topLeftCorner(samples, samples);
  Eigen::VectorXd measured(2 * samples);
  for (Eigen::Index k = 0; k < samples; ++k) {
    const Complex v = stretch.v[static_cast<std::size_t>(k)], u = v == 0.0 ? 1.0 : v / std::abs(v);
    const double along = square(stretch.magnitude),
                 across = square(std::abs(v) * stretch.angle + stretch.magnitude);
    measured[k] = v.real();
    measured[samples + k] = v.imag();
    covariance(k, k) += along * square(u.real()) + across * square(u.imag());
    covariance(samples + k, samples + k) += along * square(u.imag()) + across * square(u.real());
    covariance(samples + k, k) = (along - across) * u.real() * u.imag();
  }
  const Eigen::LLT<Eigen::MatrixXd> root(covariance);  // uses the lower half
  const Eigen::VectorXd weighed = root.solve(measured);
  evidence_ = -0.5 * measured.dot(weighed) - root.matrixLLT().diagonal().array().log().sum();
  coefficients_ = roots * weighed.reshaped(samples, 2);
  for (std::size_t i = 0; i < segments_.size(); ++i)
    priors[i].matrixU().solveInPlace(coefficients_.middleRows(segments_[i].first, segments_[i].spans + 3));
}

void ReconstructedCurve::set_segments(const FilteredSamples& stretch, const FilterWindow& window,
                                      const std::vector<double>& switching_times) {
  const double aim = std::max(stretch.step / 2, window.half() / 8);
  double from = stretch.t.front() - window.half();
  const auto add = [&](double to) {
    const int spans = std::max(1, static_cast<int>(std::ceil((to - from) / aim)));
    segments_.push_back({from, (to - from) / spans, spans, count_});
    count_ += spans + 3;
    from = to;
  };
  for (const double switching_time : switching_times) add(switching_time);
  add(stretch.t.back() + window.half());
}

Eigen::MatrixXd ReconstructedCurve::averages(const FilteredSamples& stretch,
                                             const FilterWindow& window) const {
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
        if (from < at && at < to) {  // the corner of a triangular window divides the interval
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

Eigen::MatrixXd ReconstructedCurve::prior(const Segment& s, double roughness) {
  Eigen::MatrixXd P = Eigen::MatrixXd::Identity(s.spans + 3, s.spans + 3) / (kAnyVoltage * kAnyVoltage);
  for (int span = 0; span < s.spans; ++span)
    P.block<4, 4>(span, span) += bends() / (roughness * s.span * s.span * s.span);
  return P;
}

Complex ReconstructedCurve::operator()(int segment, double t) const {
  const Segment& s = segments_[static_cast<std::size_t>(segment)];
  const int span = std::clamp(static_cast<int>((t - s.from) / s.span), 0, s.spans - 1);
  const auto shape = cubics((t - s.from) / s.span - span);
  Complex v = 0;
  for (int j = 0; j < 4; ++j) {
    const auto c = coefficients_.row(s.first + span + j);
    v += shape[static_cast<std::size_t>(j)] * Complex(c[0], c[1]);
  }
  return v;
}

}  // namespace swingbank::validate::switching
