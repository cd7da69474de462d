#include "validate/calibrate/detail/voltage_noise.hpp"

#include <cmath>

#include "validate/event/play.hpp"
#include "validate/noise/noise_events.hpp"
#include "validate/noise/slow_noise.hpp"

namespace swingbank::validate::calibrate {
namespace {

constexpr double kKick = 1e-3;             ///< impulse in one sample of V (relative) or theta [rad]
constexpr double kSettle = 3, kFade = 12;  ///< duration before and after the impulse [s]

/// Whitened residual of the playback, and its sensitivities.
struct WhitenedResidual {
  Eigen::VectorXd residual;
  Eigen::MatrixXd sensitivities;
};
WhitenedResidual whitened_residual(const sim::plant::PlantUnderTest& tested, noise::WhitenedEvent e,
                                   const std::vector<playin::SensitivityParameter>& along) {
  const playin::Response r = event::play(tested, e.event, {}, along, {.tolerance = 1e-8, .hasty = false});
  const auto n = static_cast<Eigen::Index>(along.size());
  noise::RowMatrix all(e.event.values(), n + 1);
  for (Eigen::Index d = 0; d < n; ++d)
    all.col(d) = e.event.collected(r.sensitivities[static_cast<std::size_t>(d)].value, false);
  all.col(n) = e.event.collected(r.value, true);
  e.noise.whiten(all);
  return {all.col(n), all.leftCols(n)};
}

}  // namespace

VoltagePull voltage_pull(const sim::plant::PlantUnderTest& tested,
                         const sim::plant::PlantUnderTest& whitening, const noise::WhitenedEvents& events,
                         const noise::VoltageNoise& voltage, const std::vector<fit::FreeParameter>& free) {
  double samples = 0;
  for (const auto& e : events) samples += e.record.samples();
  std::vector<playin::SensitivityParameter> along;
  for (const auto& f : free)
    along.push_back({.kind = playin::SensitivityParameter::Kind::parameter,
                     .parameter = f.id,
                     .scale = fit::axis_unit(tested.plant, f)});
  const event::FitEvent quiet = noise::at_rest(events.front(), kSettle + kFade);
  const auto at = static_cast<std::size_t>(kSettle / quiet.record.step());
  noise::EventNoise noise = events.noise(0);
  noise.memory = noise::memory_of(whitening, {quiet, noise}, voltage);
  const WhitenedResidual still = whitened_residual(tested, {quiet, noise}, along);
  const Eigen::MatrixXd carried = voltage.into(quiet);
  const auto n = static_cast<Eigen::Index>(free.size());
  VoltagePull pull{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  const Eigen::Vector3d variance = voltage.of(quiet);
  for (const Eigen::Index of : {0, 1, 2}) {
    if (variance[of] == 0) continue;
    event::FitEvent kicked = quiet;
    record::Record& r = kicked.record;
    if (of == 0) r.V[at] += kKick * r.V[at];
    if (of == 1) r.theta[at] += kKick;
    for (std::size_t k = at; of == 2 && k < r.theta.size(); ++k) r.theta[k] += kKick;
    for (std::size_t c = 0; of < 2 && c < kicked.channels.size(); ++c) {
      const double more = kKick * carried(static_cast<Eigen::Index>(c), of);
      if (kicked.channels[c] == playin::Output::P) r.P[at] += more;
      if (kicked.channels[c] == playin::Output::Q) r.Q[at] += more;
    }
    const WhitenedResidual moved = whitened_residual(tested, {kicked, noise}, along);
    const Eigen::MatrixXd sensitivities = (moved.sensitivities - still.sensitivities) / kKick;
    const Eigen::VectorXd residual = (moved.residual - still.residual) / kKick;
    const double times = samples * variance[of];
    const Eigen::VectorXd score = times * sensitivities.transpose() * residual;
    pull.score += score;
    pull.information += times * sensitivities.transpose() * sensitivities;
    pull.doubt += voltage.doubt[of] * voltage.doubt[of] * score * score.transpose();
  }
  return pull;
}

}  // namespace swingbank::validate::calibrate
