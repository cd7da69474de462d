#pragma once
// Time at which a signal leaves its level, and end of the steady state before an event.
#include <cstddef>
#include <span>

#include "validate/record/record.hpp"

namespace swingbank::validate::switching {

/// Returns the last of the first n samples before P and Q step together, n - 1 if they do not. A distant load
/// switching may move V by no more than its noise; the machine's response exceeds it through its admittance.
std::size_t before_power_step(const record::Record& record, std::size_t n);

/// Returns the time of the last sample before V leaves its level of the first half second [s], whether it
/// switches or not.
double steady_until(const record::Record& record);

/// Criterion for a signal that leaves its level.
struct Leaving {
  double level = 0,
         reach = 0;  ///< both in the signal's unit; a sample further than `reach` from the level has left it
  std::size_t from = 0;      ///< first sample to test
  std::size_t in_a_row = 2;  ///< required number of consecutive samples; noise alone seldom reaches two
};
/// Returns the first of these samples; the signal's length if there is none.
std::size_t leaves(std::span<const double> signal, const Leaving& rule);

}  // namespace swingbank::validate::switching
