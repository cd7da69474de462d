#pragma once
// Levenberg-Marquardt fit of a machine's equations to a record without noise. The voltage is played in, and
// rotor angle and speed are those of the record. Only the flux states are integrated. They decay from their
// initial values and do not oscillate.
#include <span>
#include <vector>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// Least-squares estimate of the parameters.
struct Refined {
  std::vector<double> p;       ///< all parameters of the effect
  double rms_error = 0;        ///< root mean square of the residuals [pu]
  int iterations = 0;          ///< number of iterations, including rejected steps
  std::vector<int> idle = {};  ///< positions in `free` of parameters without influence, left at their start
};
/// Effort of the least-squares estimate.
struct RefineOptions {
  int iterations = 25;   ///< largest number of iterations, including rejected steps
  double longest = 6.0;  ///< maximum length of the segment, from the last voltage step [s]
};

/// Fits the parameters `free` (indices) within `low` and `high`; the others keep their value in `start`.
/// `machine`: an effect of the machine slot with its voltage behind a constant impedance. The rotor angle at
/// the first sample and the fluxes at the segment's start are fitted as well. H and D have no influence here.
/// Every second sample is compared: the current, multiplied by the reactance, and the field current if
/// recorded.
Refined refine(const Effect& machine, const Recording& record, std::vector<double> start,
               std::span<const int> free, std::span<const double> low, std::span<const double> high,
               const RefineOptions& options = {});

/// Refines the candidates in turn. Returns the first candidate whose residual is as small as the record's
/// noise before the event allows. If there is none, refines further random starts around the best candidate
/// and returns the best result. For a machine without flux states, returns the first candidate unchanged.
Refined refine_best(const Effect& machine, const Recording& record,
                    std::span<const std::vector<double>> candidates, std::span<const int> free,
                    std::span<const double> low, std::span<const double> high,
                    const RefineOptions& options = {});

}  // namespace swingbank::sim::direct
