#pragma once
// Time at which a signal leaves its level, and end of the steady state before an event.
#include <cstddef>
#include <span>

#include "validate/record/record.hpp"

namespace swingbank::validate::switching {

/// Returns the index of the last sample before P and Q have a common step within the first n samples; n - 1
/// without such a step. A distant load switching may change V by less than its noise. The changes of P and Q
/// exceed their noise, because they are the change of V times the machine's admittance.
std::size_t before_power_step(const record::Record& record, std::size_t n);

/// Returns the time [s] of the last sample before V leaves its level of the first 0.5 s, by a step or
/// gradually.
double steady_until(const record::Record& record);

/// Criterion for a signal that leaves its level.
struct Leaving {
  double level = 0,
         reach = 0;  ///< both in the signal's unit; a sample further than `reach` from the level has left it
  std::size_t from = 0;      ///< first sample to test
  std::size_t in_a_row = 2;  ///< required number of consecutive samples; noise alone seldom reaches two
};
/// Returns the index of the first of `in_a_row` samples that have left the level; the signal's length if
/// there are none.
std::size_t leaves(std::span<const double> signal, const Leaving& rule);

}  // namespace swingbank::validate::switching
