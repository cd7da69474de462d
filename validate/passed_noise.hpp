#pragma once
// What noise of the played-in voltage a structure passes into its answer. One that passes less of it explains
// the records better without explaining anything: a current that is late by part of a sample is read between
// the samples, where the curve through them is smoother than the noise on them.
#include "validate/fit_event.hpp"

namespace swingbank::validate {

class PassedNoise {
 public:
  /// Of a structure that others are held against. Noise of these variances [V/V, rad], for a minute at the
  /// first event's operating point; whitened as what is behind this structure.
  PassedNoise(const sim::Plant& plant, const sim::Conventions& conventions,
              const std::vector<FitEvent>& events, const Eigen::Vector2d& variance);
  /// By how much chi2 of all events falls with another structure because that passes less; negative if it
  /// passes more, 0 where it cannot be run.
  [[nodiscard]] double less_with(const sim::Plant& plant, const sim::Conventions& conventions) const;
  /// What the structure itself adds to chi2 of all events.
  [[nodiscard]] double own() const { return own_; }

 private:
  /// NaN where it cannot be run.
  [[nodiscard]] double passed(const sim::Plant& plant, const sim::Conventions& conventions) const;

  FitEvent quiet_, noisy_;
  double times_ = 0;  ///< values of the events per value of the minute
  double own_ = 0;
};

}  // namespace swingbank::validate
