#pragma once
// The state variables of one event: switching times, phase jumps of an angle integrated from frequency,
// operating point and initial motion.
#include <array>
#include <vector>

#include "validate/event/play.hpp"
#include "validate/noise/whitened_events.hpp"
#include "validate/playin/play_in.hpp"

namespace swingbank::validate::fit {

/// Returns the number of switching times and angle jumps, which come before the other variables.
inline std::size_t switching_numbers(const event::FitEvent& event) {
  return event.switchings.size() * (event.turns() ? 2 : 1);
}

/// Unit of a switching time in the search [s].
inline constexpr double kSwitchScale = 1e-3;
/// Unit of an angle jump in the search [rad], and its prior standard deviation in this unit. An error of 20 %
/// in a reactance causes an error of about 0.1 rad in the jump.
inline constexpr double kTurnScale = 1e-3, kTurnPrior = 100;  ///< [rad]; [kTurnScale]

inline constexpr int kStates = 4;  ///< number of initial states: P, Q [pu], angle [rad], speed [pu]
/// Kind of each initial state, in the order of this list.
inline constexpr std::array<playin::SensitivityParameter::Kind, kStates> kStateKind = {
    playin::SensitivityParameter::Kind::P, playin::SensitivityParameter::Kind::Q,
    playin::SensitivityParameter::Kind::angle, playin::SensitivityParameter::Kind::speed};
/// Unit of each initial state in the search. It is far below observable changes and far above rounding
/// errors.
inline constexpr std::array<double, kStates> kStateScale = {1e-3, 1e-3, 1e-3, 1e-5};
/// Prior standard deviation of each initial state [kStateScale]. It is small, because a plant is nearly in
/// steady state before an event.
inline constexpr double kStatePrior = 20;

/// Returns the prior standard deviation of each state variable, in units of the search; 0: no prior.
inline std::vector<double> state_priors(const event::FitEvent& event) {
  std::vector<double> all(event.switchings.size(), 0.0);
  all.resize(switching_numbers(event), kTurnPrior);
  all.insert(all.end(), kStates, kStatePrior);
  return all;
}

/// Returns the event's state in units of the search. The unmodelled inputs of the state are not included.
inline std::vector<double> state_of(const event::FitEvent& event, const event::EventState& from) {
  std::vector<double> s;
  for (std::size_t k = 0; k < event.switchings.size(); ++k)
    s.push_back((from.switchings[k] - event.switchings[k].time) / kSwitchScale);
  for (std::size_t k = 0; event.turns() && k < event.switchings.size(); ++k)
    s.push_back(k < from.turns.size() ? (from.turns[k] - event.switchings[k].turn) / kTurnScale : 0.0);
  const double values[kStates] = {from.P, from.Q, from.angle, from.speed};
  for (int k = 0; k < kStates; ++k) s.push_back(values[k] / kStateScale[k]);
  return s;
}

/// Returns the event's state from the search's variables; the inverse of state_of().
inline event::EventState event_state(const event::FitEvent& event, const double* s) {
  event::EventState at;
  for (const auto& w : event.switchings) at.switchings.push_back(w.time + kSwitchScale * *s++);
  if (event.turns())
    for (const auto& w : event.switchings) at.turns.push_back(w.turn + kTurnScale * *s++);
  at.P = kStateScale[0] * s[0];
  at.Q = kStateScale[1] * s[1];
  at.angle = kStateScale[2] * s[2];
  at.speed = kStateScale[3] * s[3];
  return at;
}

/// Returns the sensitivity parameters of the state variables.
inline std::vector<playin::SensitivityParameter> state_parameters(const event::FitEvent& event) {
  using Kind = playin::SensitivityParameter::Kind;
  std::vector<playin::SensitivityParameter> along;
  const int switchings = static_cast<int>(event.switchings.size());
  for (int k = 0; k < switchings; ++k)
    along.push_back({.kind = Kind::switching, .index = k, .scale = kSwitchScale});
  for (int k = 0; event.turns() && k < switchings; ++k)
    along.push_back({.kind = Kind::turn, .index = k, .scale = kTurnScale});
  for (int k = 0; k < kStates; ++k)
    along.push_back(
        {.kind = kStateKind[static_cast<std::size_t>(k)], .scale = kStateScale[static_cast<std::size_t>(k)]});
  return along;
}

}  // namespace swingbank::validate::fit
