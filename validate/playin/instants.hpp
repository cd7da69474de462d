#pragma once
// What finders of an event's instants have in common: how the voltage steps, and when a signal leaves where
// it stood.
#include <cstddef>
#include <span>
#include <vector>

#include "base/complex.hpp"
#include "validate/playin/voltage_curve.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::playin {

/// Change of the voltage phasor over each sample interval [pu].
std::vector<Complex> voltage_steps(const record::Record& record);

/// A switching between samples k and k + 1.
Switching within_step(const record::Record& record, std::size_t k);
/// Jumps that are small, a twentieth of `threshold` at least, and stand alone: ten samples to either side, or
/// to the record's begin, nothing bends by a fifth of it, neither noise nor a swing. A generator lost far
/// away makes such a jump.
std::vector<Switching> lone_jumps(const record::Record& record, double threshold);

/// The last of the first n samples before P and Q jump together, n - 1 where they do not. A load switched far
/// away may move V by no more than its noise; what a machine answers stands out by its admittance.
std::size_t before_power_jump(const record::Record& record, std::size_t n);

/// When a signal counts as having left its level.
struct Leaving {
  double level = 0,
         reach = 0;          ///< both in the signal's unit; it has left where it is further off than `reach`
  std::size_t from = 0;      ///< first sample that is looked at
  std::size_t in_a_row = 2;  ///< so many neighbouring samples have left; noise alone seldom takes two
};
/// The first sample of those; the signal's length where there is none.
std::size_t leaves(std::span<const double> signal, const Leaving& rule);

}  // namespace swingbank::validate::playin
