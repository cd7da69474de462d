#pragma once
// The one way in which an event is played into a plant: from the event's own state, and through the plant's
// own instruments, which show what was recorded.
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/plant/under_test.hpp"
#include "validate/event/event.hpp"

namespace swingbank::validate::event {

/// An input that no model makes, free in time.
enum class InputKind { none, torque, field };

/// What belongs to one event.
struct EventState {
  std::vector<double> switchings;  ///< [s]; empty: where they were found
  std::vector<double> turns = {};  ///< of the angle at each of them [rad]; empty: as they were found
  /// Offsets of the operating point and of the first states. Of an exciter or a governor P is that of Efd or
  /// Pm, and the others mean nothing.
  double P = 0, Q = 0, angle = 0, speed = 0;
  playin::PiecewiseLinear torque = {}, field = {};  ///< what is added to Tm and Efd [pu]
  [[nodiscard]] playin::PiecewiseLinear& input(InputKind kind) {
    return kind == InputKind::torque ? torque : field;
  }
  [[nodiscard]] const playin::PiecewiseLinear& input(InputKind kind) const {
    return kind == InputKind::torque ? torque : field;
  }
};

/// How an event is played.
struct Playing {
  double tolerance = 1e-5;  ///< error per step, relative to 1 + |state|
  /// Steps down to a fortieth of the sample interval are taken whatever their error, because a limit that is
  /// met and left within one sample is no reason for shorter ones; after 15 steps a sample it gives up.
  /// False: neither.
  bool hasty = true;
  /// A step may miss a state by what the compared channels do not show of it (playin::allowances).
  bool lenient = false;
  /// How much, kept for further plays of the same plant with other values. Empty: found, and left here. Null:
  /// found each time.
  std::vector<double>* allowance = nullptr;
  bool linear_slopes = false;                           ///< slopes as playin::Drive has them: for a search
  std::shared_ptr<const playin::Past>* past = nullptr;  ///< as playin::Drive has it
  bool instants_stand = false;                          ///< as playin::Drive has it
  double until = 1e300;                                 ///< samples after it are left out [s]
};

/// The event's switchings at the instants that `state` has.
std::vector<playin::Switching> switchings_at(const FitEvent& event, const EventState& state);
/// The operating point with the offsets that `state` has.
playin::OperatingPoint start_at(const FitEvent& event, const EventState& state);
/// What the plant answers as its instruments show it, and slopes along the directions. Throws InputError as
/// playin::observe.
playin::Response play(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                      const EventState& state, std::span<const playin::Direction> along = {},
                      const Playing& how = {});
/// The same of several plants that differ in values only, eight at a time (playin::drive_together); nothing
/// where play() would throw.
std::vector<std::optional<playin::Response>> play_together(std::span<const sim::plant::Plant> plants,
                                                           const sim::Conventions& conventions,
                                                           const FitEvent& event, const EventState& state,
                                                           const Playing& how = {});

/// How fast each state of the plant follows 1 pu of an input at the start [1/s]; the state has that input.
Eigen::VectorXd rates_by_input(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                               const EventState& state, InputKind input);
/// Inputs of the plant's controls along the event, at these times too (playin::seen_along).
playin::SeenAlong seen_along(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                             const EventState& state, std::span<const double> times = {});

}  // namespace swingbank::validate::event
