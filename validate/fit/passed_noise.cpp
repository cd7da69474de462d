#include "validate/fit/passed_noise.hpp"

#include <cmath>

#include "validate/fit/fit.hpp"
#include "validate/fit/noise.hpp"

namespace swingbank::validate::fit {

PassedNoise::PassedNoise(const sim::plant::Plant& plant, const sim::Conventions& conventions,
                         const event::WhitenedEvents& events, const Eigen::Vector2d& variance)
    : quiet_(minute_of_noise(events.front(), Eigen::Vector2d::Zero())),
      noisy_(minute_of_noise(events.front(), variance.cwiseSqrt())),
      noise_(events.noise(0)) {
  noise_.memory = memory_of(plant, conventions, {quiet_, noise_}, variance);
  double values = 0;
  for (const event::FitEvent& e : events) values += e.values();
  times_ = values / noisy_.values();
  own_ = passed(plant, conventions);
}

double PassedNoise::less_with(const sim::plant::Plant& plant, const sim::Conventions& conventions) const {
  const double less = own_ - passed(plant, conventions);
  return std::isnan(less) ? 0.0 : less;
}

double PassedNoise::passed(const sim::plant::Plant& plant, const sim::Conventions& conventions) const {
  try {
    event::RowMatrix moved = noisy_.collected(event::play(plant, conventions, noisy_, {}).value, false);
    moved -= quiet_.collected(event::play(plant, conventions, quiet_, {}).value, false);
    noise_.whiten(moved);
    return times_ * moved.squaredNorm();
  } catch (const InputError&) {
    return std::nan("");
  }
}

}  // namespace swingbank::validate::fit
