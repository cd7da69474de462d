#pragma once
// Playback of an event into a plant, from the event's own initial state and through the plant's instruments.
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/problem.hpp"
#include "sim/plant/under_test.hpp"
#include "validate/event/event.hpp"

namespace swingbank::validate::event {

/// Unmodelled input of a plant, an arbitrary function of time.
enum class InputKind { none, torque, field };

/// Fitted quantities of one event.
struct EventState {
  std::vector<double> switchings;  ///< switching times [s]; empty: those of the event
  std::vector<double> turns = {};  ///< phase jumps at the switching times [rad]; empty: those of the event
  /// Offsets of the operating point [pu on the record's base] and of the initial angle [rad] and speed [pu].
  /// For an exciter or a governor, P is the offset of Efd or Pm, and the others are unused.
  double P = 0, Q = 0, angle = 0, speed = 0;        ///< [pu], [pu], [rad], [pu]
  playin::PiecewiseLinear torque = {}, field = {};  ///< added to Tm and Efd [pu]
  /// Returns the added torque, or the added field voltage for any other kind.
  [[nodiscard]] playin::PiecewiseLinear& input(InputKind kind) {
    return kind == InputKind::torque ? torque : field;
  }
  /// The same, read only.
  [[nodiscard]] const playin::PiecewiseLinear& input(InputKind kind) const {
    return kind == InputKind::torque ? torque : field;
  }
};

/// Options of a playback.
struct Playing {
  double tolerance = 1e-5;  ///< error per step, relative to 1 + |state|
  /// If true, integration steps of 1/40 of the sample interval are accepted whatever their error, and the
  /// playback fails after 15 steps per sample on average. Shorter steps would only resolve limits that are
  /// reached and left within one sample.
  bool hasty = true;
  /// Relaxes the tolerance of each state according to the state's influence on the compared channels
  /// (playin::allowances).
  bool lenient = false;
  /// Cache of these allowances for further playbacks of the same plant with other parameter values. Empty
  /// vector: they are computed and stored here. Null pointer: they are computed each time.
  std::vector<double>* allowance = nullptr;
  std::vector<playin::Output> sensitive =
      {};  ///< outputs with sensitivities, in addition to P, Q and the compared channels
  std::shared_ptr<const playin::TrajectoryCache>* cache = nullptr;  ///< as in playin::PlaybackRun
  double until = 1e300;                                             ///< later samples are not simulated [s]
};

/// Error of a record whose playback fails for the reason `why`.
InputError playback_failure(const std::string& record, const std::string& why);

/// Returns the event's own state: its switching times, without offsets.
EventState prepared_state(const FitEvent& event);
/// Returns the event's switchings with the times and phase jumps of `state`.
std::vector<switching::Switching> switchings_at(const FitEvent& event, const EventState& state);
/// Returns the operating point with the offsets of `state`.
playin::OperatingPoint start_at(const FitEvent& event, const EventState& state);
/// Returns the plant's response through its instruments, and its sensitivities to the parameters `along`.
/// Throws InputError as playin::observe.
playin::Response play(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                      const EventState& state, std::span<const playin::SensitivityParameter> along = {},
                      const Playing& how = {});
/// Returns the responses of several plants that differ in parameter values only. Plants without instruments
/// are simulated in SIMD batches of eight (playin::simulate_playback_batch), others one by one. An entry is
/// empty if play() would throw.
std::vector<std::optional<playin::Response>> play_together(std::span<const sim::plant::Plant> plants,
                                                           const sim::Conventions& conventions,
                                                           const FitEvent& event, const EventState& state,
                                                           const Playing& how = {});

/// Returns the derivative of each state's rate with respect to an input at the start [1/s per pu].
Eigen::VectorXd rates_by_input(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                               const EventState& state, InputKind input);
/// Returns the inputs of the plant's controls during the event, also at `times` [s] (playin::seen_along).
playin::SeenAlong seen_along(const sim::plant::PlantUnderTest& tested, const FitEvent& event,
                             const EventState& state, std::span<const double> times = {});

}  // namespace swingbank::validate::event
