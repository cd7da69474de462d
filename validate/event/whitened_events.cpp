#include "validate/event/whitened_events.hpp"

#include <numeric>
#include <stdexcept>

#include "validate/playin/component.hpp"
#include "validate/playin/given.hpp"

namespace swingbank::validate::event {

const std::vector<double>& FitEvent::measured(playin::Output o) const {
  return playin::measured_values(record, o);
}

bool FitEvent::turns() const {
  return record.angle == record::AngleSource::integrated && !playin::is_part(record) && !record.breaker();
}

namespace {

/// Returns the curve; none if the voltage is invalid: playing the event then reports the reason.
KeptCurve kept_curve(const FitEvent& e) {
  const record::Record& r = e.played();
  if (r.t.empty() || r.V.size() != r.t.size() || r.theta.size() != r.t.size()) return {};
  try {
    return KeptCurve(std::make_unique<const playin::VoltageCurve>(r, e.switchings));
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace

playin::VoltageCurve FitEvent::curve(std::vector<switching::Switching> at) const {
  return kept.get() ? kept.get()->moved(played(), std::move(at))
                    : playin::VoltageCurve(played(), std::move(at));
}

Eigen::VectorXd FitEvent::collected(const std::vector<double>* values, bool less_measured) const {
  Eigen::VectorXd all(this->values());
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < record.t.size(); ++k) {
    if (!compared(k)) continue;
    for (const playin::Output o : channels)
      all[row++] = values[static_cast<int>(o)][k] - (less_measured ? measured(o)[k] : 0.0);
  }
  return all;
}

WhitenedEvents::WhitenedEvents(std::vector<FitEvent> events, NoiseModel noise) {
  for (FitEvent& e : events) {
    e.kept = kept_curve(e);
    events_.push_back(std::make_shared<const FitEvent>(std::move(e)));
  }
  *this = with(std::move(noise));
}

WhitenedEvents WhitenedEvents::with(NoiseModel noise) const {
  if (noise.size() != events_.size())
    throw std::logic_error("a noise model has one entry for each event, and these are " +
                           std::to_string(noise.size()) + " entries for " + std::to_string(events_.size()) +
                           " events: measure the noise of all events together");
  WhitenedEvents same = *this;
  same.noise_ = std::move(noise);
  same.which_.resize(events_.size());
  std::iota(same.which_.begin(), same.which_.end(), std::size_t{0});
  return same;
}

WhitenedEvents WhitenedEvents::only(const std::vector<std::size_t>& events) const {
  WhitenedEvents some;
  some.noise_ = noise_;
  for (const std::size_t e : events) {
    some.events_.push_back(events_[e]);
    some.which_.push_back(which_[e]);
  }
  return some;
}

WhitenedEvents WhitenedEvents::without(std::size_t event) const {
  std::vector<std::size_t> others;
  for (std::size_t e = 0; e < events_.size(); ++e)
    if (e != event) others.push_back(e);
  return only(others);
}

}  // namespace swingbank::validate::event
