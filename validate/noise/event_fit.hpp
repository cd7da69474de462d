#pragma once
// Comparison of a response with one event, in units of its noise.
#include <vector>

#include "validate/event/play.hpp"
#include "validate/noise/whitened_events.hpp"

namespace swingbank::validate::noise {

/// Fit of one event: its state, response and residual.
struct EventFit {
  event::EventState state;                 ///< estimate of the event's own state
  double chi2 = 0;                         ///< sum of squared whitened residuals
  int values = 0;                          ///< number of compared values
  std::vector<std::vector<double>> model;  ///< [channel][sample]
  /// Model - measured, whitened: [channel][sample]; 0 at samples that are not compared.
  std::vector<std::vector<double>> residual;
  NoiseModel noise;  ///< noise model in which chi2 and residual are computed
  /// Reduced chi-square: chi2 divided by the number of compared values [-]; 1 if the residual is noise only.
  [[nodiscard]] double reduced_chi2() const { return chi2 / values; }
};

/// Returns the states of the events.
std::vector<event::EventState> states_of(const std::vector<EventFit>& events);

/// Fills `fit`, except its state, with the comparison of `response` with one event.
void compare(const WhitenedEvents& events, std::size_t event, const playin::Response& response,
             EventFit& fit);

}  // namespace swingbank::validate::noise
