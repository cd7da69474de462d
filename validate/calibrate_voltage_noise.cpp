#include "validate/calibrate_voltage_noise.hpp"

#include <algorithm>
#include <cmath>

#include "sim/core/noise.hpp"

namespace swingbank::validate {
namespace {

constexpr double kSeconds = 60.0;  ///< of noise at the operating point
constexpr double kBlock = 0.5;  ///< length of a piece drawn from the records: colour up to there is kept [s]

/// Movements of V (relative) and theta [rad] before an event, less mean and slope.
struct Quiet {
  std::vector<double> V, theta;
};
Quiet quiet_of(const FitEvent& e) {
  Quiet q{detrended(e.record.V, e.start.samples), detrended(e.record.theta, e.start.samples)};
  for (double& v : q.V) v /= std::abs(e.start.voltage);
  return q;
}

/// A minute at the operating point of `like`, moved by pieces of what was quiet.
FitEvent minute(const FitEvent& like, const std::vector<Quiet>& quiet, double amount) {
  FitEvent event = like;
  Record& r = event.record;
  const double step = r.step(), first = r.t.front();
  const auto samples = static_cast<std::size_t>(kSeconds / step);
  const auto block = std::max<std::size_t>(1, static_cast<std::size_t>(kBlock / step));
  r.t.resize(samples);
  r.V.resize(samples);
  r.theta.resize(samples);
  const Quiet* from = nullptr;
  std::size_t at = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    if (k % block == 0) {
      const auto u = sim::uniform_pair(1, 0, k);
      from = &quiet[std::min(quiet.size() - 1,
                             static_cast<std::size_t>(u[0] * static_cast<double>(quiet.size())))];
      at = static_cast<std::size_t>(u[1] * static_cast<double>(from->V.size()));
    }
    const std::size_t i = (at + k % block) % from->V.size();
    r.t[k] = first + static_cast<double>(k) * step;
    r.V[k] = std::abs(like.start.voltage) * (1 + amount * from->V[i]);
    r.theta[k] = std::arg(like.start.voltage) + amount * from->theta[i];
  }
  for (auto* channel : {&r.P, &r.Q, &r.speed, &r.Efd, &r.Ifd}) channel->assign(samples, 0.0);
  event.switchings.clear();
  event.start.drift = 0;
  return event;
}

/// How much of the whitened answer's own movement is found in the residual, before the events.
double instrument_share(const std::vector<FitEvent>& events, const std::vector<EventSlopes>& slopes) {
  double cross = 0, own = 0;
  for (std::size_t e = 0; e < events.size(); ++e) {
    const int n = slopes[e].channels, count = events[e].start.samples;
    for (int c = 0; c < n; ++c) {
      std::vector<double> answer, residual;
      for (int k = 0; k < count; ++k) {
        answer.push_back(slopes[e].answer[k * n + c]);
        residual.push_back(slopes[e].residual[k * n + c]);
      }
      answer = detrended(answer, count);
      residual = detrended(residual, count);
      for (int k = 0; k < count; ++k) {
        cross += answer[static_cast<std::size_t>(k)] * residual[static_cast<std::size_t>(k)];
        own += std::pow(answer[static_cast<std::size_t>(k)], 2);
      }
    }
  }
  return own > 0 ? std::clamp(cross / own, 0.0, 1.0) : 0.0;
}

/// A minute at the operating point of the first event, whose V and theta move as `amount` times they do
/// before the events; answers are compared with zero.
FitEvent noisy_minute(const std::vector<FitEvent>& events, double amount) {
  std::vector<Quiet> quiet;
  for (const auto& e : events) quiet.push_back(quiet_of(e));
  return minute(events.front(), quiet, amount);
}

}  // namespace

std::vector<double> detrended(const std::vector<double>& x, int count) {
  double mean = 0, slope = 0, spread = 0;
  const double middle = 0.5 * (count - 1);
  for (int k = 0; k < count; ++k) mean += x[static_cast<std::size_t>(k)] / count;
  for (int k = 0; k < count; ++k) {
    slope += (k - middle) * (x[static_cast<std::size_t>(k)] - mean);
    spread += (k - middle) * (k - middle);
  }
  std::vector<double> rest;
  for (int k = 0; k < count; ++k)
    rest.push_back(x[static_cast<std::size_t>(k)] - mean - slope / spread * (k - middle));
  return rest;
}
VoltageNoise voltage_noise(const sim::Plant& plant, const sim::Conventions& conventions,
                           const std::vector<FitEvent>& events, const std::vector<EventSlopes>& slopes,
                           const std::vector<FreeParameter>& free) {
  double samples = 0;
  for (const auto& e : events) samples += e.record.samples();
  const EventSlopes still = event_slopes(plant, conventions, noisy_minute(events, 0), {}, free);
  const EventSlopes moved = event_slopes(plant, conventions, noisy_minute(events, 1), {}, free);
  const Eigen::MatrixXd noise = moved.slopes - still.slopes;
  const double share = instrument_share(events, slopes);
  const double times = share * samples / (static_cast<double>(moved.answer.size()) / moved.channels);
  return {share, times * noise.transpose() * (moved.answer - still.answer),
          times * noise.transpose() * noise};
}

}  // namespace swingbank::validate
