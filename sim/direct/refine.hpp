#pragma once
// Levenberg-Marquardt on a machine's own equations, from an estimate to the record's exact parameters. The
// voltage is played in and the rotor angle and speed are taken as measured, so that what is left to fit are
// the fluxes: they forget their start and do not swing.
#include <span>
#include <string>
#include <vector>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

struct Refined {
  std::vector<double> p;  ///< of every parameter of the effect
  double misfit = 0;      ///< root mean square of the compared values [pu]
  int iterations = 0;
  std::vector<int> idle = {};  ///< places in `free` of those that do not act on the fluxes; they stay
};
struct RefineOptions {
  int iterations = 25;   ///< steps that were refused count too
  double longest = 6.0;  ///< of the stretch [s]
};

/// `machine`: an effect of the machine slot whose voltage lies behind a constant impedance. `free`: indices
/// of the parameters to fit, kept between `low` and `high`; the others stay as in `start`. `angle`: of the
/// rotor against the terminal at the first sample [rad]; it is free as well, as are the states at the
/// stretch's start. H and D do not act here. What is compared: the voltage behind the impedance, and the
/// field current where recorded. Compared at every second sample.
Refined refine(const Effect& machine, const Recording& record, std::vector<double> start,
               std::span<const int> free, std::span<const double> low, std::span<const double> high,
               const RefineOptions& options = {});

/// Refines the candidates in turn and returns the best, as soon as one is as close as the record's own noise
/// before the event lets it be. Where none is, further starts are drawn about the best.
Refined refine_best(const Effect& machine, const Recording& record,
                    std::span<const std::vector<double>> candidates, std::span<const int> free,
                    std::span<const double> low, std::span<const double> high,
                    const RefineOptions& options = {});

}  // namespace swingbank::sim::direct
