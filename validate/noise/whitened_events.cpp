#include "validate/noise/whitened_events.hpp"

#include <numeric>
#include <stdexcept>

namespace swingbank::validate::noise {

WhitenedEvents::WhitenedEvents(std::vector<event::FitEvent> events, NoiseModel noise) {
  for (event::FitEvent& e : events) {
    e.keep_curve();
    events_.push_back(std::make_shared<const event::FitEvent>(std::move(e)));
  }
  *this = with(std::move(noise));
}

WhitenedEvents WhitenedEvents::with(NoiseModel noise) const {
  if (noise.size() != events_.size())
    throw std::logic_error("a noise model needs one entry for each event: " + std::to_string(noise.size()) +
                           " entries for " + std::to_string(events_.size()) +
                           " events; measure the noise of all events together");
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

}  // namespace swingbank::validate::noise
