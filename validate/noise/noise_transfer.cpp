#include "validate/noise/noise_transfer.hpp"

#include <algorithm>
#include <cmath>

#include "validate/noise/noise_events.hpp"
#include "validate/noise/slow_noise.hpp"

namespace swingbank::validate::noise {
namespace {

/// Standard deviations by which the noise variance may exceed its estimate.
constexpr double kDoubts = 3;

}  // namespace

NoiseTransfer::NoiseTransfer(const sim::plant::PlantUnderTest& tested, const WhitenedEvents& events,
                             const VoltageNoise& voltage)
    : quiet_(minute_of_noise(events.front(), Eigen::Vector3d::Zero())),
      noisy_(minute_of_noise(events.front(), voltage.variance)),
      noise_(events.noise(0)) {
  noise_.memory = memory_of(tested, {quiet_, noise_}, {.variance = voltage.variance, .own = voltage.own});
  double values = 0;
  for (const event::FitEvent& e : events) values += e.values();
  times_ = values / noisy_.values();
  own_ = chi2_of(tested);
  scale_ = 1 + kDoubts * (voltage.variance.array() > 0).select(voltage.doubt.array(), 0.0).maxCoeff();
}

double NoiseTransfer::less_with(const sim::plant::PlantUnderTest& tested) const {
  const double less = scale_ * (own_ - chi2_of(tested));
  return std::isnan(less) ? 0.0 : less;
}

double NoiseTransfer::chi2_of(const sim::plant::PlantUnderTest& tested) const {
  try {
    RowMatrix moved = noisy_.collected(event::play(tested, noisy_, {}).value, false);
    moved -= quiet_.collected(event::play(tested, quiet_, {}).value, false);
    noise_.whiten(moved);
    return times_ * moved.squaredNorm();
  } catch (const InputError&) {
    return std::nan("");
  }
}

}  // namespace swingbank::validate::noise
