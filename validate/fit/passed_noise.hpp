#pragma once
// Noise of the played-in voltage that a structure passes into its answer. A structure that passes less of it
// explains the records better without explaining anything. For example, a current that is late by part of a
// sample is read between the samples, where the curve through them is smoother than the noise on them.
#include "validate/event/event.hpp"
#include "validate/fit/noise.hpp"

namespace swingbank::validate::fit {

class PassedNoise {
 public:
  /// Takes the structure that others are held against. Noise of these variances is played in for a minute at
  /// the first event's operating point, and whitened as the residual of this structure is.
  PassedNoise(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
              const VoltageNoise& voltage);
  /// By how much chi2 of all events falls with another structure because it passes less noise. Negative if it
  /// passes more, 0 where it cannot be run.
  [[nodiscard]] double less_with(const sim::plant::PlantUnderTest& tested) const;
  /// Chi2 of all events that the structure's own passed noise makes.
  [[nodiscard]] double own() const { return own_; }

 private:
  /// Chi2 that a plant's passed noise makes; NaN where it cannot be run.
  [[nodiscard]] double passed(const sim::plant::PlantUnderTest& tested) const;

  event::FitEvent quiet_, noisy_;
  event::EventNoise noise_;  ///< of both
  double times_ = 0;         ///< values of the events per value of the minute
  double own_ = 0;
};

/// Takes down in the fit of another structure what it takes off chi2 by passing less noise. Every explanation
/// that is weighed against another one comes through here, a free input's refitted plant as well as an
/// effect. What passes more is not credited for it. Null: this noise is not considered.
void count_passed(const PassedNoise* passed, const sim::Conventions& conventions, Fit& fit);

}  // namespace swingbank::validate::fit
