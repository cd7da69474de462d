#pragma once
// Events that never change, beside one measurement of their noise. Fits take both together; to measure the
// noise anew makes another value and leaves this one as it is.
#include <Eigen/Dense>
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "validate/event/noise_model.hpp"
#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::event {

/// The curve of an event that no longer changes. A copy of the event, which may be changed, has none.
class KeptCurve {
 public:
  KeptCurve() = default;
  explicit KeptCurve(std::unique_ptr<const playin::VoltageCurve> curve) : curve_(std::move(curve)) {}
  KeptCurve(const KeptCurve&) {}
  KeptCurve(KeptCurve&&) = default;
  KeptCurve& operator=(const KeptCurve& other) {
    if (this != &other) curve_.reset();
    return *this;
  }
  KeptCurve& operator=(KeptCurve&&) = default;
  ~KeptCurve() = default;
  [[nodiscard]] const playin::VoltageCurve* get() const { return curve_.get(); }

 private:
  std::unique_ptr<const playin::VoltageCurve> curve_;
};

/// One event, prepared for fitting.
struct FitEvent {
  record::Record record;
  std::vector<playin::Switching> switchings;  ///< where they were found; those with an uncertainty are fitted
  playin::OperatingPoint start;
  /// Marks samples that an instrument's filter has smeared over a switching; these are not played in. Empty:
  /// no sample is.
  std::vector<char> smeared = {};
  /// Marks samples that are not compared: the smeared ones, and those next to a sharp switching, because a
  /// channel that is a millisecond late may lie on the other side there. Empty: no sample is.
  std::vector<char> left_out = {};
  /// Time, V and theta of the samples that are not smeared, and of those that unsmear() brought back. Empty
  /// where none is smeared.
  record::Record clean = {};
  std::vector<playin::Output> channels;  ///< measured ones: P, Q, then speed, Efd, Ifd where recorded
  KeptCurve kept = {};                   ///< of played() with `switchings`, in WhitenedEvents
  /// The voltage that is played in, with the switchings at these instants.
  [[nodiscard]] playin::VoltageCurve curve(std::vector<playin::Switching> at) const;
  /// One of Response's answers or slopes ([output][sample]), with the measured values taken off where asked:
  /// [compared sample * channels + channel].
  [[nodiscard]] Eigen::VectorXd collected(const std::vector<double>* values, bool less_measured) const;
  [[nodiscard]] const std::vector<double>& measured(playin::Output o) const;
  /// Whether the angle turns by an unknown amount at each switching, because it was integrated from a
  /// frequency.
  [[nodiscard]] bool turns() const;
  /// The record that is played in.
  [[nodiscard]] const record::Record& played() const { return smeared.empty() ? record : clean; }
  [[nodiscard]] bool compared(std::size_t sample) const { return left_out.empty() || !left_out[sample]; }
  /// How many numbers are compared.
  [[nodiscard]] int values() const {
    const auto missing = std::ranges::count(left_out, 1);
    return (record.samples() - static_cast<int>(missing)) * static_cast<int>(channels.size());
  }
};

/// One event beside its noise. Both stay where they are kept.
struct WhitenedEvent {
  const FitEvent& event;
  const EventNoise& noise;
};

/// A range of events with their noise. Copies share the events.
class WhitenedEvents {
 public:
  class Iterator;
  WhitenedEvents() = default;
  WhitenedEvents(std::vector<FitEvent> events, NoiseModel noise);

  [[nodiscard]] std::size_t size() const { return events_.size(); }
  [[nodiscard]] bool empty() const { return events_.empty(); }
  [[nodiscard]] const FitEvent& operator[](std::size_t event) const { return *events_[event]; }
  [[nodiscard]] const FitEvent& front() const { return *events_.front(); }
  [[nodiscard]] Iterator begin() const;
  [[nodiscard]] Iterator end() const;

  [[nodiscard]] const EventNoise& noise(std::size_t event) const { return noise_.of(which_[event]); }
  [[nodiscard]] WhitenedEvent whitened(std::size_t event) const { return {*events_[event], noise(event)}; }
  /// The measurement that the noise comes from.
  [[nodiscard]] const NoiseModel& noise_model() const { return noise_; }

  /// The same events with another measurement of their noise, which has one entry for each of them.
  [[nodiscard]] WhitenedEvents with(NoiseModel noise) const;
  /// Some of the events, with the same measurement.
  [[nodiscard]] WhitenedEvents only(const std::vector<std::size_t>& events) const;
  [[nodiscard]] WhitenedEvents alone(std::size_t event) const { return only({event}); }
  [[nodiscard]] WhitenedEvents without(std::size_t event) const;

 private:
  std::vector<std::shared_ptr<const FitEvent>> events_;
  std::vector<std::size_t> which_;  ///< place of each event in the measurement
  NoiseModel noise_;
};

/// Goes through the events of WhitenedEvents.
class WhitenedEvents::Iterator {
 public:
  using value_type = FitEvent;
  using difference_type = std::ptrdiff_t;
  using Place = std::vector<std::shared_ptr<const FitEvent>>::const_iterator;
  Iterator() = default;
  explicit Iterator(Place at) : at_(at) {}
  const FitEvent& operator*() const { return **at_; }
  Iterator& operator++() {
    ++at_;
    return *this;
  }
  Iterator operator++(int) { return Iterator(at_++); }
  friend bool operator==(const Iterator&, const Iterator&) = default;

 private:
  Place at_;
};
inline WhitenedEvents::Iterator WhitenedEvents::begin() const { return Iterator(events_.begin()); }
inline WhitenedEvents::Iterator WhitenedEvents::end() const { return Iterator(events_.end()); }

}  // namespace swingbank::validate::event
