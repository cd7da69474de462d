#include "validate/noise/noise_events.hpp"

#include <cmath>
#include <limits>

#include "sim/core/noise.hpp"
#include "validate/noise/voltage_noise.hpp"
#include "validate/playin/given.hpp"

namespace swingbank::validate::noise {

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

}  // namespace swingbank::validate::noise
