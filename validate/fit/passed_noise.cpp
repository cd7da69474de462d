#include "validate/fit/passed_noise.hpp"

#include <algorithm>
#include <cmath>

namespace swingbank::validate::fit {

PassedNoise::PassedNoise(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
                         const VoltageNoise& voltage)
    : quiet_(minute_of_noise(events.front(), Eigen::Vector3d::Zero())),
      noisy_(minute_of_noise(events.front(), voltage.variance)),
      noise_(events.noise(0)) {
  noise_.memory = memory_of(tested, {quiet_, noise_}, {.variance = voltage.variance, .own = voltage.own});
  double values = 0;
  for (const event::FitEvent& e : events) values += e.values();
  times_ = values / noisy_.values();
  own_ = passed(tested);
}

double PassedNoise::less_with(const sim::plant::PlantUnderTest& tested) const {
  const double less = own_ - passed(tested);
  return std::isnan(less) ? 0.0 : less;
}

double PassedNoise::passed(const sim::plant::PlantUnderTest& tested) const {
  try {
    event::RowMatrix moved = noisy_.collected(event::play(tested, noisy_, {}).value, false);
    moved -= quiet_.collected(event::play(tested, quiet_, {}).value, false);
    noise_.whiten(moved);
    return times_ * moved.squaredNorm();
  } catch (const InputError&) {
    return std::nan("");
  }
}

void count_passed(const PassedNoise* passed, const sim::Conventions& conventions, Fit& fit) {
  if (passed && fit.failed.empty())
    fit.passes_less = std::max(0.0, passed->less_with({fit.plant, conventions}));
}

}  // namespace swingbank::validate::fit
