#include "validate/passed_noise.hpp"

#include <cmath>

#include "validate/fit.hpp"
#include "validate/instruments.hpp"
#include "validate/noise.hpp"

namespace swingbank::validate {
namespace {

Response answer(const sim::Plant& plant, const sim::Conventions& conventions, const FitEvent& e) {
  const VoltageCurve curve(e.record, {});
  Drive run = drive_at(plant, conventions, e, {});
  run.curve = &curve;
  return observe(run);
}

}  // namespace

PassedNoise::PassedNoise(const sim::Plant& plant, const sim::Conventions& conventions,
                         const std::vector<FitEvent>& events, const Eigen::Vector2d& variance)
    : quiet_(minute_of_noise(events.front(), Eigen::Vector2d::Zero())),
      noisy_(minute_of_noise(events.front(), variance.cwiseSqrt())) {
  noisy_.memory = memory_of(plant, conventions, quiet_, variance);
  double values = 0;
  for (const FitEvent& e : events) values += e.values();
  times_ = values / noisy_.values();
  own_ = passed(plant, conventions);
}

double PassedNoise::less_with(const sim::Plant& plant, const sim::Conventions& conventions) const {
  const double less = own_ - passed(plant, conventions);
  return std::isnan(less) ? 0.0 : less;
}

double PassedNoise::passed(const sim::Plant& plant, const sim::Conventions& conventions) const {
  try {
    RowMatrix moved = noisy_.collected(answer(plant, conventions, noisy_).value, false);
    moved -= quiet_.collected(answer(plant, conventions, quiet_).value, false);
    noisy_.whiten(moved);
    return times_ * moved.squaredNorm();
  } catch (const InputError&) {
    return std::nan("");
  }
}

}  // namespace swingbank::validate
