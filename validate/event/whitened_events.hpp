#pragma once
// Immutable events with one estimate of their noise. Fits take both together; another estimate of the noise
// gives another value and leaves this one unchanged.
#include <Eigen/Dense>
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "validate/event/noise_model.hpp"
#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::event {

/// Cached voltage curve of an immutable event. Copies of the event may be changed, so a copy starts without
/// it.
class KeptCurve {
 public:
  KeptCurve() = default;
  /// Takes ownership of the curve; null: none.
  explicit KeptCurve(std::unique_ptr<const playin::VoltageCurve> curve) : curve_(std::move(curve)) {}
  /// A copy starts without a curve.
  KeptCurve(const KeptCurve&) {}
  /// Moves the curve.
  KeptCurve(KeptCurve&&) = default;
  /// Removes the curve, since the event is overwritten.
  KeptCurve& operator=(const KeptCurve& other) {
    if (this != &other) curve_.reset();
    return *this;
  }
  /// Moves the curve.
  KeptCurve& operator=(KeptCurve&&) = default;
  ~KeptCurve() = default;
  /// Returns the curve; null if there is none.
  [[nodiscard]] const playin::VoltageCurve* get() const { return curve_.get(); }

 private:
  std::unique_ptr<const playin::VoltageCurve> curve_;
};

/// One event, prepared for fitting.
struct FitEvent : switching::SwitchedRecord {
  playin::OperatingPoint start = {};  ///< operating point before the event
  /// Marks samples that are not compared: the filtered ones, lost ones, and those next to a sharp switching,
  /// where a delay of a millisecond may put a channel on the other side. Empty: none.
  std::vector<char> left_out = {};
  std::vector<playin::Output> channels = {};  ///< measured ones: P, Q, then speed, Efd, Ifd if recorded
  KeptCurve kept = {};                        ///< of played() with `switchings`, in WhitenedEvents
  /// Returns the played-in voltage with the given switchings.
  [[nodiscard]] playin::VoltageCurve curve(std::vector<switching::Switching> at) const;
  /// Returns an output or a sensitivity of Response ([output][sample]) as a vector
  /// [compared sample * channels + channel], minus the measured values if `less_measured`.
  [[nodiscard]] Eigen::VectorXd collected(const std::vector<double>* values, bool less_measured) const;
  /// Returns the recorded samples of a channel, in the unit of Response.
  [[nodiscard]] const std::vector<double>& measured(playin::Output o) const;
  /// Returns whether the angle turns by an unknown amount at each switching, because it was integrated from a
  /// frequency.
  [[nodiscard]] bool turns() const;
  /// Returns the played-in record.
  [[nodiscard]] const record::Record& played() const { return filtered_samples.empty() ? record : clean; }
  /// Returns whether a sample is compared.
  [[nodiscard]] bool compared(std::size_t sample) const { return left_out.empty() || !left_out[sample]; }
  /// Returns the number of compared values.
  [[nodiscard]] int values() const {
    const auto missing = std::ranges::count(left_out, 1);
    return (record.samples() - static_cast<int>(missing)) * static_cast<int>(channels.size());
  }
};

/// References to one event and its noise, both owned by WhitenedEvents.
struct WhitenedEvent {
  const FitEvent& event;    ///< event with its record
  const EventNoise& noise;  ///< noise of its channels
};

/// A range of events with their noise. Copies share the events.
class WhitenedEvents {
 public:
  class Iterator;
  WhitenedEvents() = default;
  /// Takes the events, and caches the voltage curve of each. `noise` has one entry for each event.
  WhitenedEvents(std::vector<FitEvent> events, NoiseModel noise);

  [[nodiscard]] std::size_t size() const { return events_.size(); }  ///< number of events
  [[nodiscard]] bool empty() const { return events_.empty(); }       ///< whether there is none
  /// Event by index.
  [[nodiscard]] const FitEvent& operator[](std::size_t event) const { return *events_[event]; }
  [[nodiscard]] const FitEvent& front() const { return *events_.front(); }  ///< first event
  /// Returns an iterator to the first event.
  [[nodiscard]] Iterator begin() const;
  /// Returns the iterator behind the last event.
  [[nodiscard]] Iterator end() const;

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
  std::vector<std::shared_ptr<const FitEvent>> events_;
  std::vector<std::size_t> which_;  ///< index of each event in the noise estimate
  NoiseModel noise_;
};

/// Iterator over the events of WhitenedEvents.
class WhitenedEvents::Iterator {
 public:
  using value_type = FitEvent;             ///< element of the range
  using difference_type = std::ptrdiff_t;  ///< distance of two iterators
  using Place = std::vector<std::shared_ptr<const FitEvent>>::const_iterator;
  ///< position in the list of events
  Iterator() = default;
  /// Constructs an iterator at a position.
  explicit Iterator(Place at) : at_(at) {}
  const FitEvent& operator*() const { return **at_; }  ///< the event at the position
  /// Advances to the next event; returns the iterator.
  Iterator& operator++() {
    ++at_;
    return *this;
  }
  /// Advances to the next event; returns the position before.
  Iterator operator++(int) { return Iterator(at_++); }
  /// Compares positions.
  friend bool operator==(const Iterator&, const Iterator&) = default;

 private:
  Place at_;
};
inline WhitenedEvents::Iterator WhitenedEvents::begin() const { return Iterator(events_.begin()); }
inline WhitenedEvents::Iterator WhitenedEvents::end() const { return Iterator(events_.end()); }

}  // namespace swingbank::validate::event
