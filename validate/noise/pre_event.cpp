#include "validate/noise/pre_event.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "validate/event/play.hpp"

namespace swingbank::validate::noise {
namespace {

/// Returns the residual before the event, [channel][sample], minus each channel's mean.
Eigen::MatrixXd quiet_residual(const sim::plant::PlantUnderTest& tested, const event::FitEvent& e) {
  const event::Playing how{
      .tolerance = 1e-8, .hasty = false, .until = e.record.t[static_cast<std::size_t>(e.start.samples - 1)]};
  const playin::Response r = event::play(tested, e, {}, {}, how);
  Eigen::MatrixXd residual(e.channels.size(), e.start.samples);
  for (std::size_t c = 0; c < e.channels.size(); ++c)
    for (int k = 0; k < e.start.samples; ++k)
      residual(static_cast<Eigen::Index>(c), k) = r.of(e.channels[c])[static_cast<std::size_t>(k)] -
                                                  e.measured(e.channels[c])[static_cast<std::size_t>(k)];
  residual.colwise() -= residual.rowwise().mean().eval();
  return residual;
}

/// Estimates the noise of each event from the pre-event residuals of all events with the same channels.
template <class Events>
NoiseModel noise_through(const sim::plant::PlantUnderTest& tested, const Events& events) {
  std::vector<EventNoise> noise;
  for (const event::FitEvent& e : events) {
    const auto n = static_cast<Eigen::Index>(e.channels.size());
    Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(n, n);
    int freedom = 0;
    for (const event::FitEvent& other : events) {
      if (other.channels != e.channels) continue;
      const Eigen::MatrixXd residual = quiet_residual(tested, other);
      scatter += residual * residual.transpose();
      freedom += other.start.samples - 1;
    }
    Eigen::MatrixXd covariance = scatter / freedom;
    for (Eigen::Index c = 0; c < n; ++c) {
      const bool speed = e.channels[static_cast<std::size_t>(c)] == playin::Output::speed;
      const double step = record::quantum(e.measured(e.channels[static_cast<std::size_t>(c)]));
      covariance(c, c) = std::max(covariance(c, c), step * step / 12);
      const playin::Output o = e.channels[static_cast<std::size_t>(c)];
      const double per_machine =  // P and Q are on the record's base, the floor on the machine's
          o == playin::Output::P || o == playin::Output::Q ? tested.plant.mva / e.record.base.mva : 1.0;
      covariance(c, c) += std::pow(speed ? kLeastSpeedNoise : switching::kLeastNoise * per_machine, 2);
    }
    noise.push_back({.deviation = covariance.diagonal().cwiseSqrt(),
                     .whitening = covariance.llt().matrixL().solve(Eigen::MatrixXd::Identity(n, n))});
  }
  return NoiseModel(std::move(noise));
}

}  // namespace

WhitenedEvents with_noise(const plant::PlantModel& model, std::vector<event::FitEvent> events) {
  NoiseModel noise = noise_through(model.under_test(), events);
  return {std::move(events), std::move(noise)};
}

WhitenedEvents whitened_events(const plant::PlantModel& model, std::vector<record::Record> records,
                               const event::FitEventOptions& options) {
  return with_noise(model, event::prepare_events(model, std::move(records), options));
}

NoiseModel measure_noise(const sim::plant::PlantUnderTest& tested, const WhitenedEvents& events) {
  return noise_through(tested, events);
}

}  // namespace swingbank::validate::noise
