#include "validate/calibrate/detail/voltage_noise.hpp"

#include <cmath>

#include "validate/fit/noise.hpp"

namespace swingbank::validate::calibrate {

VoltagePull voltage_pull(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
                         const Eigen::Vector2d& variance, const std::vector<fit::FreeParameter>& free) {
  double samples = 0;
  for (const auto& e : events) samples += e.record.samples();
  const event::FitEvent quiet = fit::minute_of_noise(events.front(), Eigen::Vector2d::Zero()),
                        noisy = fit::minute_of_noise(events.front(), variance.cwiseSqrt());
  event::EventNoise noise = events.noise(0);
  noise.memory = fit::memory_of(tested, {quiet, noise}, variance);
  const fit::EventSlopes still = fit::event_slopes(tested, {quiet, noise}, {}, free);
  const fit::EventSlopes moved = fit::event_slopes(tested, {noisy, noise}, {}, free);
  const Eigen::MatrixXd passed = moved.slopes - still.slopes;
  const double times = samples / quiet.record.samples();
  return {times * passed.transpose() * (moved.residual - still.residual),
          times * passed.transpose() * passed};
}

}  // namespace swingbank::validate::calibrate
