#pragma once
// Transfer of the played-in voltage's noise into the response of a structure. A structure with lower noise
// transfer has a lower chi2 without explaining anything. Example: a current with a delay of a part of a
// sample is interpolated, and the interpolated curve is smoother than the noise of the samples.
#include "validate/noise/voltage_noise.hpp"

namespace swingbank::validate::noise {

/// Noise transfer of a reference structure, with which other structures are compared.
class NoiseTransfer {
 public:
  /// Sets the reference structure. Noise of these variances is played in for one minute at the first event's
  /// operating point and whitened as the residual of this structure.
  NoiseTransfer(const sim::plant::PlantUnderTest& tested, const WhitenedEvents& events,
                const VoltageNoise& voltage);
  /// Returns the fall of chi2 over all events due to the lower noise transfer of another structure. Negative
  /// if its transfer is higher, 0 if it cannot be simulated.
  [[nodiscard]] double less_with(const sim::plant::PlantUnderTest& tested) const;
  /// Returns chi2 over all events due to the reference structure's noise transfer.
  [[nodiscard]] double own() const { return own_; }

 private:
  /// Returns chi2 due to a plant's noise transfer; NaN if it cannot be simulated.
  [[nodiscard]] double chi2_of(const sim::plant::PlantUnderTest& tested) const;

  event::FitEvent quiet_, noisy_;
  EventNoise noise_;  ///< of both
  double times_ = 0;  ///< ratio of the events' number of values to the minute's
  double own_ = 0;
};

}  // namespace swingbank::validate::noise
