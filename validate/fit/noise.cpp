#include "validate/fit/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/MatrixFunctions>

#include "base/constants.hpp"
#include "sim/core/noise.hpp"
#include "validate/playin/given.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::fit {
namespace {

/// Samples this close to a switching are left out on either side [s].
constexpr double kBeside = 0.1;
/// Median of the square of a standard normal variable.
constexpr double kMedianOfSquare = 0.4549;
/// Variance of x[k-1] - 2 x[k] + x[k+1], relative to that of white x.
constexpr double kSecondDifference = 6;
/// The standard deviation of log(mean square second difference / variance) of n white samples is
/// sqrt(kOfRatio / n). It combines the variance's 2 and the differences' 3.89, less twice the covariance's 2.
constexpr double kOfRatio = 2 * 0.944;

/// Residual statistics of a channel over all events.
struct Channel {
  std::vector<double> square;  ///< squared second differences of the whole records
  double quiet = 0,
         quiet_hf = 0;  ///< before the events: sums of squared deviations and of squared second differences
  int samples = 0, differences = 0;  ///< number of samples and of second differences
};

void add(const event::FitEvent& e, const EventFit& f, std::size_t c, Channel& channel) {
  const auto& measured = e.measured(e.channels[c]);
  const auto residual = [&](std::size_t k) { return f.model[c][k] - measured[k]; };
  const auto counts = [&](std::size_t k) {
    return e.compared(k) && std::ranges::none_of(e.switchings, [&](const switching::Switching& s) {
             return std::abs(e.record.t[k] - s.time) < kBeside;
           });
  };
  const auto before = static_cast<std::size_t>(e.start.samples);
  double mean = 0;
  for (std::size_t k = 0; k < before; ++k) mean += residual(k) / static_cast<double>(before);
  for (std::size_t k = 0; k < before; ++k) channel.quiet += std::pow(residual(k) - mean, 2);
  channel.samples += e.start.samples - 1;
  for (std::size_t k = 1; k + 1 < e.record.t.size(); ++k) {
    if (!counts(k - 1) || !counts(k) || !counts(k + 1)) continue;
    const double d = std::pow(residual(k - 1) - 2 * residual(k) + residual(k + 1), 2);
    channel.square.push_back(d);
    if (k + 1 >= before) continue;
    channel.quiet_hf += d;
    ++channel.differences;
  }
}

/// Returns the variance of the noise relative to the pre-event segment; 1 if that segment is not white.
double ratio(Channel channel) {
  const double variance = channel.quiet / channel.samples, hf = channel.quiet_hf / channel.differences;
  const double off = std::log(hf / (kSecondDifference * variance));
  if (!(std::abs(off) < 3 * std::sqrt(kOfRatio / channel.samples))) return 1.0;
  const auto middle = channel.square.begin() + static_cast<std::ptrdiff_t>(channel.square.size() / 2);
  std::ranges::nth_element(channel.square, middle);
  return *middle / kMedianOfSquare / kSecondDifference / variance;
}

constexpr double kLow = 3.0, kHigh = 10.0;  ///< band in which the voltage's noise is estimated [Hz]
constexpr double kGuess = 2e-3;             ///< standard deviation of V near a switching, relative
/// The square of kGuess is larger by this factor for reconstructed samples of V.
constexpr char kFiltered = 40;
/// Lower limit of the share of a channel's own noise in its variance.
constexpr double kLeastOwnNoise = 0.01;
/// Slow noise matters from this variance, relative to that of the white noise.
constexpr double kMatters = 1e-3;

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

/// Returns whether a switching or a missing sample lies in the segment or near it.
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
Moving moving_in_band(const event::WhitenedEvents& events) {
  constexpr double kBeyond = 3.0;  // standard deviations
  // Shorter segments contain too few bins to estimate the noise level. The pre-event segment may be one of
  // these, so the estimate is repeated kLevels times.
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
  /// Normal matrix of the response and of the fluctuation carried by P and Q.
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();  ///< products of these with the residual
  double left = 0, freedom = 0;
  void add(const Sums& other) {
    normal += other.normal;
    right += other.right;
    left += other.left;
    freedom += other.freedom;
  }
  /// Returns the sum of squares of the residual after subtraction of this combination.
  [[nodiscard]] double rest(const Eigen::Vector2d& x) const {
    return std::max(0.0, left - 2 * x.dot(right) + x.dot(normal * x));
  }
};
std::array<Sums, playin::kOutputs> sums_of(const Fit& fit, const event::WhitenedEvents& events) {
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
      const Eigen::ArrayXd response = detrended(fit.events[i].model[c], n) / noise,
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
Shares shares_of(const Fit& fit, const event::WhitenedEvents& events) {
  const auto sums = sums_of(fit, events);
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

/// Returns whether the slow noise of any channel has a relevant variance by the end of the record.
bool matters(const event::SlowNoise& s, const event::WhitenedEvent& e) {
  Eigen::MatrixXd P = s.P;
  for (int k = 0; k < e.event.record.samples(); ++k) P = (s.A * P * s.A.transpose() + s.Q).eval();
  const Eigen::MatrixXd slow = e.noise.whitening * s.C * P * s.C.transpose() * e.noise.whitening.transpose();
  return slow.diagonal().maxCoeff() > kMatters;
}

}  // namespace

event::NoiseModel sharpen_noise(const Fit& fit, const event::WhitenedEvents& events) {
  std::vector<event::EventNoise> sharper;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const event::EventNoise& noise = events.noise(i);
    Eigen::VectorXd scale(noise.deviation.size());
    for (std::size_t c = 0; c < events[i].channels.size(); ++c) {
      Channel channel;
      for (std::size_t e = 0; e < events.size(); ++e)
        if (events[e].channels == events[i].channels) add(events[e], fit.events[e], c, channel);
      scale[static_cast<Eigen::Index>(c)] =
          channel.samples > 0 && channel.differences > 0 ? std::sqrt(ratio(std::move(channel))) : 1.0;
    }
    sharper.push_back({noise.deviation.cwiseProduct(scale),
                       noise.whitening * scale.cwiseInverse().asDiagonal(), noise.memory});
  }
  return event::NoiseModel(std::move(sharper));
}

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

event::SlowNoise slow_noise(const playin::LinearPlant& plant, event::WhitenedEvent whitened,
                            const VoltageNoise& voltage) {
  const event::FitEvent& e = whitened.event;
  const event::EventNoise& noise = whitened.noise;
  const Eigen::Index n = plant.A.rows(), m = n + 2, count = static_cast<Eigen::Index>(e.channels.size());
  Eigen::MatrixXd C(count, n), D(count, 2);
  for (Eigen::Index c = 0; c < count; ++c) {
    C.row(c) = plant.C.row(static_cast<Eigen::Index>(e.channels[static_cast<std::size_t>(c)]));
    D.row(c) = plant.D.row(static_cast<Eigen::Index>(e.channels[static_cast<std::size_t>(c)]));
  }
  // The voltage is linear over one sample: x1 = F x0 + G u0 + H (u1 - u0).
  const double h = e.record.step();
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(n + 4, n + 4);
  whole.topLeftCorner(n, n) = h * plant.A;
  whole.block(0, n, n, 2) = h * plant.B;
  whole.block(n, n + 2, 2, 2).setIdentity();
  whole = whole.exp().eval();
  const Eigen::MatrixXd F = whole.topLeftCorner(n, n), G = whole.block(0, n, n, 2),
                        H = whole.topRightCorner(n, 2);
  const Eigen::MatrixXd in = F * H + G - H, through = D + C * H - voltage.into(e);
  const Eigen::Vector3d variance = voltage.of(e);
  const Eigen::MatrixXd V = variance.head(2).asDiagonal();

  event::SlowNoise s;
  s.A = Eigen::MatrixXd::Identity(m, m);
  s.A.topLeftCorner(n, n) = F;
  s.A.topRightCorner(n, 2) = G;
  s.C.resize(count, m);
  s.C << C, D - voltage.into(e);
  s.P = s.Q = Eigen::MatrixXd::Zero(m, m);
  s.P.bottomRightCorner(2, 2) = V / e.start.samples;
  s.Q.topLeftCorner(n, n) = in * V * in.transpose();
  s.Q(m - 1, m - 1) = variance[2];
  // Near a switching, the voltage between samples is interpolated.
  s.added_covariance = Eigen::MatrixXd::Zero(m, m);
  s.added_covariance.topLeftCorner(n, n) = kGuess * kGuess * in * in.transpose();
  s.doubtful.assign(e.record.t.size(), 0);
  for (std::size_t k = 0; k + 1 < e.record.t.size(); ++k) {
    const bool switched = std::ranges::any_of(e.switchings, [&](const switching::Switching& w) {
      return e.record.t[k] <= w.time && w.time < e.record.t[k + 1];
    });
    s.doubtful[k] = !e.filtered_samples.empty() && e.filtered_samples[k] ? kFiltered : switched ? 1 : 0;
  }
  s.M = Eigen::MatrixXd::Zero(m, count);
  s.M.topRows(n) = in * V * through.transpose();
  // The measured noise contains the immediate effect of the voltage's noise. The remainder, a difference of
  // two large variances, is inaccurate; the channels' own noise is its lower limit.
  const Eigen::MatrixXd scale = noise.deviation.asDiagonal(),
                        unit = noise.deviation.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd white = unit * noise.whitening.inverse();
  const Eigen::MatrixXd at_once = unit * through * V * through.transpose() * unit;
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index c = 0; c < count; ++c)
    own(c, c) = std::max(kLeastOwnNoise,
                         voltage.own[static_cast<std::size_t>(e.channels[static_cast<std::size_t>(c)])]);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> more(white * white.transpose() - at_once - own);
  s.S = scale *
        (at_once + own +
         more.eigenvectors() * more.eigenvalues().cwiseMax(0.0).asDiagonal() *
             more.eigenvectors().transpose()) *
        scale;
  return s;
}

event::FitEvent at_rest(const event::FitEvent& like, double seconds) {
  event::FitEvent event = like;
  record::Record& r = event.record;
  const double step = r.step(), first = r.t.front();
  const auto samples = static_cast<std::size_t>(seconds / step);
  r.t.resize(samples);
  for (std::size_t k = 0; k < samples; ++k) r.t[k] = first + static_cast<double>(k) * step;
  r.V.assign(samples, std::abs(like.start.voltage));
  r.theta.assign(samples, std::arg(like.start.voltage));
  for (auto* channel : {&r.P, &r.Q, &r.speed, &r.Efd, &r.Ifd}) channel->assign(samples, 0.0);
  if (r.component != record::Component::plant) playin::set_to_initial(r, like.start);
  for (record::StagedEvent& e : r.staged) e.time = std::numeric_limits<double>::infinity();
  event.switchings.clear();
  event.filtered_samples.clear();
  event.left_out.clear();
  event.start.drift = 0;
  return event;
}

event::FitEvent minute_of_noise(const event::FitEvent& like, const Eigen::Vector3d& variance) {
  const Eigen::Vector3d deviation = VoltageNoise{.variance = variance}.of(like).cwiseSqrt();
  constexpr double kMinute = 60.0;
  event::FitEvent event = at_rest(like, kMinute);
  record::Record& r = event.record;
  double astray = 0;
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const auto normal = sim::normal_pair(1, 0, k);
    r.V[k] *= 1 + deviation[0] * normal[0];
    astray += deviation[2] * sim::normal_pair(2, 0, k)[0];
    r.theta[k] += deviation[1] * normal[1] + astray;
  }
  return event;
}

std::shared_ptr<const event::Innovations> memory_of(const sim::plant::PlantUnderTest& tested,
                                                    event::WhitenedEvent whitened,
                                                    const VoltageNoise& voltage) {
  const event::FitEvent& e = whitened.event;
  const playin::VoltageCurve curve(e.played(), e.switchings);
  const playin::PlaybackRun at{.plant = &tested.plant,
                               .conventions = tested.conventions,
                               .record = &e.record,
                               .curve = &curve,
                               .start = e.start};
  const event::SlowNoise noise = slow_noise(playin::linearise(at), whitened, voltage);
  if (!matters(noise, whitened)) return nullptr;
  return std::make_shared<event::Innovations>(noise, e.record.samples(), e.left_out);
}

VoltageNoise voltage_noise(const Fit& fit, const event::WhitenedEvents& events) {
  const Shares shares = shares_of(fit, events);
  const Moving moving = moving_in_band(events);
  return {
      .variance = shares.instrument * moving.variance,
      .carried = shares.carried,
      .share = shares.instrument,
      .doubt =
          (moving.freedom.array() > 0).select(moving.freedom.cwiseMax(1.0).cwiseSqrt().cwiseInverse(), 0.0),
      .own = shares.own};
}

event::NoiseModel remember_noise(const Fit& fit, const sim::Conventions& conventions,
                                 const event::WhitenedEvents& events) {
  const VoltageNoise voltage = voltage_noise(fit, events);
  std::vector<event::EventNoise> noise;
  for (std::size_t e = 0; e < events.size(); ++e) {
    noise.push_back(events.noise(e));
    noise.back().memory = memory_of({fit.plant, conventions}, events.whitened(e), voltage);
  }
  return event::NoiseModel(std::move(noise));
}

event::NoiseModel measure_noise_through(const Fit& fit, const sim::Conventions& conventions,
                                        const event::WhitenedEvents& events) {
  event::WhitenedEvents measured = events;
  if (fit.reduced_chi2() < thresholds::noise.measurable)
    measured = measured.with(event::measure_noise({fit.plant, conventions}, measured));
  measured = measured.with(sharpen_noise(fit, measured));
  return remember_noise(fit, conventions, measured);
}

double slow_remainder(const Fit& fit, const event::WhitenedEvents& events) {
  double worst = 0;
  for (const double seconds : {0.5, 1.0, 2.0})
    for (std::size_t c = 0; c < events.front().channels.size(); ++c) {
      double power = 0;
      int blocks = 0;
      for (std::size_t i = 0; i < events.size(); ++i) {
        if (events[i].channels != events.front().channels) continue;
        const auto& residual = fit.events[i].residual[c];
        const auto length = static_cast<std::size_t>(std::lround(seconds / events[i].record.step()));
        for (std::size_t first = 0; first + length <= residual.size(); first += length, ++blocks) {
          double sum = 0;
          for (std::size_t k = first; k < first + length; ++k) sum += residual[k];
          power += sum * sum / static_cast<double>(length);
        }
      }
      if (blocks > 0) worst = std::max(worst, (power / blocks - 1) / std::sqrt(2.0 / blocks));
    }
  return worst;
}

}  // namespace swingbank::validate::fit
