#include "validate/calibrate_voltage_noise.hpp"

#include <cmath>

#include "sim/core/noise.hpp"
#include "validate/noise.hpp"

namespace swingbank::validate {
namespace {

constexpr double kSeconds = 60.0;  ///< of noise at the operating point

/// A minute at the operating point of `like`, V and theta moved by that many standard deviations of noise;
/// answers are compared with zero.
FitEvent minute(const FitEvent& like, const Eigen::Vector2d& deviation) {
  FitEvent event = like;
  Record& r = event.record;
  const double step = r.step(), first = r.t.front();
  const auto samples = static_cast<std::size_t>(kSeconds / step);
  r.t.resize(samples);
  r.V.resize(samples);
  r.theta.resize(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    const auto normal = sim::normal_pair(1, 0, k);
    r.t[k] = first + static_cast<double>(k) * step;
    r.V[k] = std::abs(like.start.voltage) * (1 + deviation[0] * normal[0]);
    r.theta[k] = std::arg(like.start.voltage) + deviation[1] * normal[1];
  }
  for (auto* channel : {&r.P, &r.Q, &r.speed, &r.Efd, &r.Ifd}) channel->assign(samples, 0.0);
  event.switchings.clear();
  event.smeared.clear();
  event.left_out.clear();
  event.start.drift = 0;
  return event;
}

}  // namespace

VoltagePull voltage_pull(const sim::Plant& plant, const sim::Conventions& conventions,
                         const std::vector<FitEvent>& events, const Eigen::Vector2d& variance,
                         const std::vector<FreeParameter>& free) {
  double samples = 0;
  for (const auto& e : events) samples += e.record.samples();
  FitEvent quiet = minute(events.front(), Eigen::Vector2d::Zero()),
           noisy = minute(events.front(), variance.cwiseSqrt());
  quiet.memory = noisy.memory = memory_of(plant, conventions, quiet, variance);
  const EventSlopes still = event_slopes(plant, conventions, quiet, {}, free);
  const EventSlopes moved = event_slopes(plant, conventions, noisy, {}, free);
  const Eigen::MatrixXd noise = moved.slopes - still.slopes;
  const double times = samples / quiet.record.samples();
  return {times * noise.transpose() * (moved.residual - still.residual), times * noise.transpose() * noise};
}

}  // namespace swingbank::validate
