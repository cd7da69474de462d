#include "validate/calibrate/detail/voltage_noise.hpp"

#include <cmath>

#include "validate/fit/noise.hpp"

namespace swingbank::validate::calibrate {

VoltagePull voltage_pull(const sim::plant::Plant& plant, const sim::Conventions& conventions,
                         const std::vector<event::FitEvent>& events, const Eigen::Vector2d& variance,
                         const std::vector<fit::FreeParameter>& free) {
  double samples = 0;
  for (const auto& e : events) samples += e.record.samples();
  event::FitEvent quiet = fit::minute_of_noise(events.front(), Eigen::Vector2d::Zero()),
                  noisy = fit::minute_of_noise(events.front(), variance.cwiseSqrt());
  quiet.memory = noisy.memory = fit::memory_of(plant, conventions, quiet, variance);
  const fit::EventSlopes still = fit::event_slopes(plant, conventions, quiet, {}, free);
  const fit::EventSlopes moved = fit::event_slopes(plant, conventions, noisy, {}, free);
  const Eigen::MatrixXd noise = moved.slopes - still.slopes;
  const double times = samples / quiet.record.samples();
  return {times * noise.transpose() * (moved.residual - still.residual), times * noise.transpose() * noise};
}

}  // namespace swingbank::validate::calibrate
