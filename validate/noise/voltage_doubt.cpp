#include "validate/noise/voltage_doubt.hpp"

#include <cmath>
#include <span>

#include "base/constants.hpp"
#include "base/white_noise.hpp"
#include "sim/core/noise.hpp"
#include "validate/noise/beside.hpp"
#include "validate/noise/slow_noise.hpp"

namespace swingbank::validate::noise {
namespace {

/// Returns a square root of a covariance of rank three at most: columns whose outer products sum to it.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of(covariance);
  return of.eigenvectors().rightCols(3) * of.eigenvalues().tail(3).cwiseMax(0.0).cwiseSqrt().asDiagonal();
}
/// Returns the variance per sample of the random walk of an angle that was integrated from f [rad^2]. A meter
/// with a symmetric window shows the phase jump of a switching already before the switching. The last samples
/// before the first switching are therefore not used, unless fewer than three, the least for an estimate,
/// remain.
double astray(const event::FitEvent& e) {
  const record::Record& r = e.record;
  const auto all = static_cast<std::size_t>(e.start.samples);
  std::size_t n = all;
  if (!e.switchings.empty())
    while (n > 0 && r.t[n - 1] > e.switchings.front().time - kBeside) --n;
  const auto f = std::span(r.f).first(n < 3 ? all : n);
  return white_variance(f) * std::pow(constants::turn * r.base.frequency * r.step(), 2);
}

/// Returns the plant's response to impulses on its states: [channel][sample].
template <class Kick>
VoltageDoubt::Shape impulse_response(const SlowNoise& noise, std::size_t samples, Kick kick) {
  VoltageDoubt::Shape shape(static_cast<std::size_t>(noise.C.rows()), std::vector<double>(samples, 0.0));
  Eigen::VectorXd x = kick(-1);
  for (std::size_t k = 0; k < samples; ++k) {
    const Eigen::VectorXd seen = noise.C * x;
    for (std::size_t c = 0; c < shape.size(); ++c) shape[c][k] = seen[static_cast<Eigen::Index>(c)];
    x = noise.A * x + kick(static_cast<int>(k));
  }
  return shape;
}

}  // namespace

VoltageDoubt voltage_doubt(const sim::plant::PlantUnderTest& tested, WhitenedEvent whitened) {
  const event::FitEvent& e = whitened.event;
  constexpr std::uint32_t kDraws = 48;  // enough for a standard error of 20 % of a variance
  const std::size_t samples = e.record.t.size();
  const auto quiet = static_cast<std::size_t>(e.start.samples);
  const bool integrated = e.record.angle == record::AngleSource::integrated;
  const Eigen::Vector3d variance(
      white_variance(std::span(e.record.V).first(quiet)) / std::norm(e.start.voltage),
      integrated ? 0.0 : white_variance(std::span(e.record.theta).first(quiet)),
      integrated ? astray(e) : 0.0);
  const playin::VoltageCurve curve(e.record, {});
  const SlowNoise noise = slow_noise(playin::linearise({.plant = &tested.plant,
                                                        .conventions = tested.conventions,
                                                        .record = &e.record,
                                                        .curve = &curve,
                                                        .start = e.start}),
                                     whitened, {.variance = variance});
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(noise.A.rows());
  VoltageDoubt doubt;
  for (const Eigen::Index j : {0, 1}) {
    Eigen::VectorXd mean = none;
    mean[none.size() - 2 + j] = std::sqrt(variance[j] / e.start.samples);
    doubt.shapes.push_back(impulse_response(noise, samples, [&](int k) { return k < 0 ? mean : none; }));
  }
  const Eigen::MatrixXd moved = root_of(noise.Q) / std::sqrt(kDraws),
                        guessed = root_of(noise.added_covariance);
  for (std::uint32_t d = 0; d < kDraws && variance.maxCoeff() > 0; ++d)
    doubt.shapes.push_back(impulse_response(noise, samples, [&](int k) -> Eigen::VectorXd {
      if (k < 0) return none;
      const auto normal = sim::normal_pair(1, d, static_cast<std::uint64_t>(k));
      const double third = integrated ? sim::normal_pair(2, d, static_cast<std::uint64_t>(k))[0] : 0.0;
      return moved * Eigen::Vector3d(third, normal[0], normal[1]);
    }));
  for (std::size_t at = 0; at < samples; ++at)
    for (Eigen::Index j = 1; noise.doubtful[at] > 0 && j < 3; ++j)  // two: V and theta
      doubt.shapes.push_back(impulse_response(noise, samples, [&](int k) -> Eigen::VectorXd {
        return k == static_cast<int>(at) ? (std::sqrt(noise.doubtful[at]) * guessed.col(j)).eval() : none;
      }));
  return doubt;
}

}  // namespace swingbank::validate::noise
