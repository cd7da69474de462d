#include "validate/passed_noise.hpp"

#include <cmath>

#include "sim/core/noise.hpp"
#include "validate/fit.hpp"
#include "validate/instruments.hpp"
#include "validate/noise.hpp"

namespace swingbank::validate {
namespace {

constexpr double kSeconds = 60.0;  ///< of noise

/// V and theta stand as before the event, moved by so many standard deviations of noise.
FitEvent standing(const FitEvent& like, const Eigen::Vector2d& deviation) {
  FitEvent event = like;
  Record& r = event.record;
  const double step = r.step(), first = r.t.front();
  const auto samples = static_cast<std::size_t>(kSeconds / step);
  for (auto* channel : {&r.t, &r.V, &r.theta}) channel->resize(samples);
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

Response answer(const sim::Plant& plant, const sim::Conventions& conventions, const FitEvent& e) {
  const VoltageCurve curve(e.record, {});
  Drive run = drive_at(plant, conventions, e, {});
  run.curve = &curve;
  return observe(run);
}

}  // namespace

PassedNoise::PassedNoise(const sim::Plant& plant, const sim::Conventions& conventions,
                         const std::vector<FitEvent>& events, const Eigen::Vector2d& variance)
    : quiet_(standing(events.front(), Eigen::Vector2d::Zero())),
      noisy_(standing(events.front(), variance.cwiseSqrt())) {
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
