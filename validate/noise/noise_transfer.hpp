#pragma once
// Transfer of the played-in voltage's noise into the response of a structure. A structure (set of effects)
// with lower noise transfer has a lower chi2, although it explains the event no better. Example: a delay of a
// fraction of a sample interpolates the current, which smooths its noise.
#include "validate/noise/voltage_noise.hpp"

namespace swingbank::validate::noise {

/// Noise transfer of a reference structure, with which other structures are compared.
class NoiseTransfer {
 public:
  /// Sets the reference structure. One minute of voltage noise with the variances of `voltage` is played in
  /// at the first event's operating point. The response is whitened with the noise model of the reference
  /// structure.
  NoiseTransfer(const sim::plant::PlantUnderTest& tested, const WhitenedEvents& events,
                const VoltageNoise& voltage);
  /// Returns the reduction of chi2 over all events that results from the lower noise transfer of another
  /// structure, if the noise variance is three of its standard deviations above its estimate. Negative if its
  /// transfer is higher, 0 if it cannot be simulated.
  [[nodiscard]] double less_with(const sim::plant::PlantUnderTest& tested) const;
  /// Returns chi2 over all events due to the reference structure's noise transfer.
  [[nodiscard]] double own() const { return own_; }

 private:
  /// Returns chi2 due to a plant's noise transfer; NaN if it cannot be simulated.
  [[nodiscard]] double chi2_of(const sim::plant::PlantUnderTest& tested) const;

  event::FitEvent quiet_, noisy_;
  EventNoise noise_;  ///< noise with which quiet_ and noisy_ are whitened
  double times_ = 0;  ///< number of values in all events over the number in the simulated minute
  double own_ = 0;
  double scale_ = 1;  ///< largest noise variance that `voltage` allows, relative to its estimate
};

}  // namespace swingbank::validate::noise
