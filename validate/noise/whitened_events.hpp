#pragma once
// Immutable events with one estimate of their noise. A fit takes events and noise together. Another noise
// estimate gives a new object and leaves this one unchanged.
#include <boost/iterator/indirect_iterator.hpp>
#include <cstddef>
#include <memory>
#include <vector>

#include "validate/event/fit_event.hpp"
#include "validate/noise/noise_model.hpp"

namespace swingbank::validate::noise {

/// References to one event and its noise. Both must outlive this object.
struct WhitenedEvent {
  const event::FitEvent& event;  ///< event with its record
  const EventNoise& noise;       ///< noise of its channels
};

/// A range of events with their noise. Copies share the events.
class WhitenedEvents {
 public:
  /// Iterator over the events.
  using Iterator =
      boost::indirect_iterator<std::vector<std::shared_ptr<const event::FitEvent>>::const_iterator>;
  WhitenedEvents() = default;
  /// Takes the events, and caches the voltage curve of each. `noise` has one entry for each event.
  WhitenedEvents(std::vector<event::FitEvent> events, NoiseModel noise);

  [[nodiscard]] std::size_t size() const { return events_.size(); }  ///< number of events
  [[nodiscard]] bool empty() const { return events_.empty(); }       ///< whether there is none
  /// Event by index.
  [[nodiscard]] const event::FitEvent& operator[](std::size_t event) const { return *events_[event]; }
  [[nodiscard]] const event::FitEvent& front() const { return *events_.front(); }  ///< first event
  /// Returns an iterator to the first event.
  [[nodiscard]] Iterator begin() const { return Iterator(events_.begin()); }
  /// Returns the iterator behind the last event.
  [[nodiscard]] Iterator end() const { return Iterator(events_.end()); }

  /// Returns the noise of an event.
  [[nodiscard]] const EventNoise& noise(std::size_t event) const { return noise_.of(which_[event]); }
  /// Returns an event with its noise.
  [[nodiscard]] WhitenedEvent whitened(std::size_t event) const { return {*events_[event], noise(event)}; }
  /// Returns the noise estimate of the events.
  [[nodiscard]] const NoiseModel& noise_model() const { return noise_; }

  /// Returns the same events with another noise estimate, which has one entry for each of them.
  [[nodiscard]] WhitenedEvents with(NoiseModel noise) const;
  /// Returns a subset of the events with the same noise estimate.
  [[nodiscard]] WhitenedEvents only(const std::vector<std::size_t>& events) const;
  /// Returns a single event with its noise.
  [[nodiscard]] WhitenedEvents alone(std::size_t event) const { return only({event}); }
  /// Returns all events except one.
  [[nodiscard]] WhitenedEvents without(std::size_t event) const;

 private:
  std::vector<std::shared_ptr<const event::FitEvent>> events_;
  std::vector<std::size_t> which_;  ///< index of each event in the noise estimate
  NoiseModel noise_;
};

}  // namespace swingbank::validate::noise
