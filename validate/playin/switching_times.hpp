#pragma once
// Common parts of the detection of switching times: steps of the voltage, and the time at which a signal
// leaves its level.
#include <cstddef>
#include <span>
#include <vector>

#include "base/complex.hpp"
#include "validate/playin/voltage_curve.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::playin {

/// Returns the change of the voltage phasor over each sample interval [pu].
std::vector<Complex> voltage_steps(const record::Record& record);

/// Returns a switching between samples k and k + 1.
Switching within_step(const record::Record& record, std::size_t k);
/// Finds small isolated steps, of at least a twentieth of `threshold`, as from the loss of a distant
/// generator. Over ten samples on either side, or to the start of the record, no second difference from noise
/// or a swing exceeds a fifth of the step.
std::vector<Switching> find_isolated_steps(const record::Record& record, double threshold);

/// Returns the last of the first n samples before P and Q step together, n - 1 if they do not. A distant load
/// switching may move V by no more than its noise; the machine's response exceeds it through its admittance.
std::size_t before_power_step(const record::Record& record, std::size_t n);

/// Criterion for a signal that leaves its level.
struct Leaving {
  double level = 0,
         reach = 0;  ///< both in the signal's unit; a sample further than `reach` from the level has left it
  std::size_t from = 0;      ///< first sample to test
  std::size_t in_a_row = 2;  ///< required number of consecutive samples; noise alone seldom reaches two
};
/// Returns the first of these samples; the signal's length if there is none.
std::size_t leaves(std::span<const double> signal, const Leaving& rule);

}  // namespace swingbank::validate::playin
