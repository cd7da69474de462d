#include "validate/calibrate_voltage_noise.hpp"

#include <cmath>

#include "validate/noise.hpp"

namespace swingbank::validate {

VoltagePull voltage_pull(const sim::Plant& plant, const sim::Conventions& conventions,
                         const std::vector<FitEvent>& events, const Eigen::Vector2d& variance,
                         const std::vector<FreeParameter>& free) {
  double samples = 0;
  for (const auto& e : events) samples += e.record.samples();
  FitEvent quiet = minute_of_noise(events.front(), Eigen::Vector2d::Zero()),
           noisy = minute_of_noise(events.front(), variance.cwiseSqrt());
  quiet.memory = noisy.memory = memory_of(plant, conventions, quiet, variance);
  const EventSlopes still = event_slopes(plant, conventions, quiet, {}, free);
  const EventSlopes moved = event_slopes(plant, conventions, noisy, {}, free);
  const Eigen::MatrixXd noise = moved.slopes - still.slopes;
  const double times = samples / quiet.record.samples();
  return {times * noise.transpose() * (moved.residual - still.residual), times * noise.transpose() * noise};
}

}  // namespace swingbank::validate
