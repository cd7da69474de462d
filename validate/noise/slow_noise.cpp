#include "validate/noise/slow_noise.hpp"

#include <algorithm>
#include <unsupported/Eigen/MatrixFunctions>

namespace swingbank::validate::noise {
namespace {

constexpr double kGuess = 2e-3;  ///< relative standard deviation of V near a switching
/// Ratio of the error variance of a reconstructed sample of V to that near a switching.
constexpr char kFiltered = 40;
/// Lower limit of the fraction of a channel's variance that is its own noise.
constexpr double kLeastOwnNoise = 0.01;
/// Slow noise is negligible up to this variance, relative to that of the white noise.
constexpr double kMatters = 1e-3;

/// Returns whether the slow noise of any channel has a relevant variance by the end of the record.
bool matters(const SlowNoise& s, const WhitenedEvent& e) {
  Eigen::MatrixXd P = s.P;
  for (int k = 0; k < e.event.record.samples(); ++k) P = (s.A * P * s.A.transpose() + s.Q).eval();
  const Eigen::MatrixXd slow = e.noise.whitening * s.C * P * s.C.transpose() * e.noise.whitening.transpose();
  return slow.diagonal().maxCoeff() > kMatters;
}

}  // namespace

SlowNoise slow_noise(const playin::LinearPlant& plant, WhitenedEvent whitened, const VoltageNoise& voltage) {
  const event::FitEvent& e = whitened.event;
  const EventNoise& noise = whitened.noise;
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

  SlowNoise s;
  s.A = Eigen::MatrixXd::Identity(m, m);
  s.A.topLeftCorner(n, n) = F;
  s.A.topRightCorner(n, 2) = G;
  s.C.resize(count, m);
  s.C << C, D - voltage.into(e);
  s.P = s.Q = Eigen::MatrixXd::Zero(m, m);
  s.P.bottomRightCorner(2, 2) = V / e.start.samples;
  s.Q.topLeftCorner(n, n) = in * V * in.transpose();
  s.Q(m - 1, m - 1) = variance[2];
  // Between the samples next to a switching, the voltage is interpolated with an error of kGuess.
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
  // The measured noise contains the immediate effect of the voltage noise. The remainder is an inaccurate
  // difference of two large variances, so the channels' own noise is its lower limit.
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

std::shared_ptr<const Innovations> memory_of(const sim::plant::PlantUnderTest& tested, WhitenedEvent whitened,
                                             const VoltageNoise& voltage) {
  const event::FitEvent& e = whitened.event;
  const playin::VoltageCurve curve = e.curve(e.switchings);
  const playin::PlaybackRun at{.plant = &tested.plant,
                               .conventions = tested.conventions,
                               .record = &e.record,
                               .curve = &curve,
                               .start = e.start};
  const SlowNoise noise = slow_noise(playin::linearise(at), whitened, voltage);
  if (!matters(noise, whitened)) return nullptr;
  return std::make_shared<Innovations>(noise, e.record.samples(), e.left_out);
}

}  // namespace swingbank::validate::noise
