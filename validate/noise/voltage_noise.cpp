#include "validate/noise/voltage_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "validate/noise/beside.hpp"

namespace swingbank::validate::noise {
namespace {

constexpr double kLow = 3.0, kHigh = 10.0;  ///< band in which the voltage's noise is estimated [Hz]

/// Returns the first `count` values without their mean and linear trend.
template <class T>
Eigen::ArrayX<T> detrended(const std::vector<T>& x, int count) {
  const Eigen::Map<const Eigen::ArrayX<T>> values(x.data(), count);
  const Eigen::ArrayX<T> ramp = Eigen::ArrayXd::LinSpaced(count, -1.0, 1.0).cast<T>();
  return values - values.mean() - (values * ramp).sum() / ramp.square().sum() * ramp;
}

/// Power in the band in one segment of a record: sums over frequency bins for V (relative), for theta, and
/// for the increments of an integrated theta.
struct Band {
  Eigen::Array3d sum = Eigen::Array3d::Zero(), lines = Eigen::Array3d::Zero();
  void add(const Band& other) {
    sum += other.sum;
    lines += other.lines;
  }
  /// Returns the variances of white noise with the same spectral density.
  [[nodiscard]] Eigen::Vector3d level() const { return sum / lines.max(1.0); }
};

bool integrated(const event::FitEvent& e) { return e.record.angle == record::AngleSource::integrated; }

/// Hann windows with 50 % overlap correlate neighbouring bins. The effective number of independent bins is
/// the number of bins divided by this factor (Welch, IEEE Trans. Audio Electroacoust. 15, 1967, p. 70).
constexpr double kLinesPerFreedom = 2.06;

/// Returns the weights of bin m for a segment of n samples: a Hann-windowed complex exponential without its
/// mean and linear trend. In a segment of 0.2 s the trend contains a quarter of the lowest bin.
Eigen::ArrayXcd line_of(int n, int m) {
  std::vector<Complex> wave;
  for (int k = 0; k < n; ++k)
    wave.push_back(std::polar(std::pow(std::sin(0.5 * constants::turn * (k + 0.5) / n), 2),
                              constants::turn * m * k / n));
  return detrended(wave, n);
}

/// Returns the band's power in n samples from `first` on.
Band in_band(const event::FitEvent& e, std::size_t first, int n) {
  const auto power = [&](const std::vector<double>& x, const Eigen::ArrayXcd& line) {
    const Eigen::Map<const Eigen::ArrayXd> piece(x.data() + first, n);
    return std::norm((piece.cast<Complex>() * line).sum()) / line.abs2().sum();
  };
  const double per_angle =
      integrated(e) ? constants::turn * e.record.base.frequency * e.record.step() : 1.0;  // angle per step
  const double apart = 1 / (n * e.record.step());
  Band band;
  const Eigen::Index of_angle = integrated(e) ? 2 : 1;
  for (int m = static_cast<int>(std::ceil(kLow / apart)); m * apart <= kHigh && 2 * m < n; ++m) {
    const Eigen::ArrayXcd line = line_of(n, m);
    band.sum[0] += power(e.record.V, line) / std::norm(e.start.voltage);
    band.sum[of_angle] += power(integrated(e) ? e.record.f : e.record.theta, line) * per_angle * per_angle;
    ++band.lines[0];
    ++band.lines[of_angle];
  }
  return band;
}

/// Returns whether a sample of the segment is not compared, or a switching lies in the segment or near it.
bool disturbed(const event::FitEvent& e, std::size_t first, std::size_t n) {
  const std::size_t last = first + n - 1;
  for (std::size_t k = first; k <= last; ++k)
    if (!e.compared(k)) return true;
  return std::ranges::any_of(e.switchings, [&](const switching::Switching& s) {
    return e.record.t[first] - kBeside < s.time && s.time < e.record.t[last] + kBeside;
  });
}

/// Variances (VoltageNoise) of white noise with the spectral density of V and angle in the band. The data are
/// the segments before the events and all later segments with no higher level. `freedom`: effective number of
/// independent bins of each estimate.
struct Moving {
  Eigen::Vector3d variance, freedom;
};
Moving moving_in_band(const WhitenedEvents& events) {
  constexpr double kBeyond = 3.0;  // standard deviations
  // Shorter segments contain too few bins to estimate the noise level. The pre-event segment may be shorter,
  // so the estimate is repeated kLevels times.
  constexpr double kStretch = 1.0;  // [s]
  constexpr int kLevels = 3;
  Band before;
  std::vector<Band> later;
  for (const event::FitEvent& e : events) {
    before.add(in_band(e, 0, e.start.samples));
    const int n = std::max(e.start.samples, static_cast<int>(std::lround(kStretch / e.record.step())));
    const auto length = static_cast<std::size_t>(n), half = (length + 1) / 2;
    for (auto first = static_cast<std::size_t>(e.start.samples + 1) / 2; first + length <= e.record.t.size();
         first += half)
      if (!disturbed(e, first, length)) later.push_back(in_band(e, first, n));
  }
  Moving all;
  for (const Eigen::Index c : {0, 1, 2}) {
    Band calm = before;
    for (int round = 0; round < kLevels && before.lines[c] > 0; ++round) {
      const double level = calm.level()[c], lines = calm.lines[c];
      calm = before;
      for (const Band& b : later) {
        const double off = std::sqrt(kLinesPerFreedom * (1.0 / std::max(1.0, b.lines[c]) + 1.0 / lines));
        if (b.lines[c] > 0 && b.level()[c] <= level * (1 + kBeyond * off)) calm.add(b);
      }
    }
    all.variance[c] = calm.level()[c];
    all.freedom[c] = calm.lines[c] / kLinesPerFreedom;
  }
  return all;
}

/// Sums of the least-squares regression of the pre-event residual, in units of each channel's noise.
struct Sums {
  /// Normal matrix of the simulated response and of the voltage fluctuation contained in P and Q.
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();  ///< scalar products of both with the residual
  double left = 0, freedom = 0;
  void add(const Sums& other) {
    normal += other.normal;
    right += other.right;
    left += other.left;
    freedom += other.freedom;
  }
  /// Returns the sum of squares of the residual after subtraction of both responses, times the coefficients
  /// x.
  [[nodiscard]] double rest(const Eigen::Vector2d& x) const {
    return std::max(0.0, left - 2 * x.dot(right) + x.dot(normal * x));
  }
};
std::array<Sums, playin::kOutputs> sums_of(const std::vector<EventFit>& fits, const WhitenedEvents& events) {
  constexpr double kOfLine = 2;  // degrees of freedom of mean and linear trend
  std::array<Sums, playin::kOutputs> sums;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const event::FitEvent& e = events[i];
    const int n = e.start.samples;
    const Eigen::ArrayXd V = detrended(e.record.V, n) / std::abs(e.start.voltage),
                         theta = detrended(e.record.theta, n);
    const Eigen::MatrixXd into = VoltageNoise{.carried = 1}.into(e);
    for (std::size_t c = 0; c < e.channels.size(); ++c) {
      const auto row = static_cast<Eigen::Index>(c);
      const double noise = events.noise(i).deviation[row];
      const Eigen::ArrayXd response = detrended(fits[i].model[c], n) / noise,
                           measured = detrended(e.measured(e.channels[c]), n) / noise;
      Eigen::ArrayX2d by(n, 2);
      by << response, -(into(row, 0) * V + into(row, 1) * theta) / noise;
      const Eigen::VectorXd residual = response - measured;
      sums[static_cast<std::size_t>(e.channels[c])].add({by.matrix().transpose() * by.matrix(),
                                                         by.matrix().transpose() * residual,
                                                         residual.squaredNorm(), n - kOfLine});
    }
  }
  return sums;
}

/// Least-squares coefficients of the pre-event residual on the simulated response (`instrument`) and on the
/// voltage fluctuation at constant current (`carried`). `own` is the remaining variance, the channels' own
/// noise.
struct Shares {
  double instrument = 1, carried = 0;
  std::array<double, playin::kOutputs> own{};
};
Shares shares_of(const std::vector<EventFit>& fits, const WhitenedEvents& events) {
  const auto sums = sums_of(fits, events);
  Sums all;
  for (const Sums& one : sums) all.add(one);
  if (!(all.normal.determinant() > 1e-9 * all.normal(0, 0) * all.normal(1, 1))) return {};
  const Eigen::Matrix2d inverse = all.normal.inverse();
  const Eigen::Vector2d found = inverse * all.right;
  const double scatter = all.rest(found) / std::max(1.0, all.freedom - 2);
  // One standard error is added, so that the share is not underestimated.
  Shares shares{.instrument = std::clamp(found[0] + std::sqrt(scatter * inverse(0, 0)), 0.0, 1.0)};
  if (shares.instrument > 0) shares.carried = std::clamp(found[1] / shares.instrument, 0.0, 1.0);
  for (std::size_t c = 0; c < sums.size(); ++c)
    if (sums[c].freedom > 0) shares.own[c] = sums[c].rest(found) / sums[c].freedom;
  return shares;
}

}  // namespace

Eigen::MatrixXd VoltageNoise::into(const event::FitEvent& event) const {
  const auto count = static_cast<Eigen::Index>(event.channels.size());
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(count, 2);
  const double P = carried * event.start.P, Q = carried * event.start.Q;
  for (Eigen::Index c = 0; c < count; ++c) {
    const playin::Output o = event.channels[static_cast<std::size_t>(c)];
    if (o == playin::Output::P) by.row(c) << P, -Q;
    if (o == playin::Output::Q) by.row(c) << Q, P;
  }
  return by;
}

Eigen::Vector3d VoltageNoise::of(const event::FitEvent& event) const {
  return integrated(event) ? Eigen::Vector3d(variance[0], 0.0, variance[2])
                           : Eigen::Vector3d(variance[0], variance[1], 0.0);
}

VoltageNoise voltage_noise(const std::vector<EventFit>& fits, const WhitenedEvents& events) {
  const Shares shares = shares_of(fits, events);
  const Moving moving = moving_in_band(events);
  return {
      .variance = shares.instrument * moving.variance,
      .carried = shares.carried,
      .share = shares.instrument,
      .doubt =
          (moving.freedom.array() > 0).select(moving.freedom.cwiseMax(1.0).cwiseSqrt().cwiseInverse(), 0.0),
      .own = shares.own};
}

}  // namespace swingbank::validate::noise
