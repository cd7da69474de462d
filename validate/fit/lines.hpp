#pragma once
// A steady oscillation in what a fit leaves, too small to show in chi2 or in slow means.
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// An oscillation of one frequency, with an amplitude and a phase of its own in each event.
struct Line {
  playin::Output channel = playin::Output::P;
  double frequency = 0;  ///< [Hz]
  /// chi2 that it takes off, beyond the price of its amplitudes and of the choice among all that were looked
  /// at; below 0 in most residuals that are noise.
  double explains = 0;
};
/// The one that explains most. Of white noise the periodogram is exponentially distributed, each frequency by
/// itself, so that those of several events add up (J. Follum, J. W. Pierre, IEEE Trans. Power Syst. 31 (2016)
/// 2423). Looks from two periods in the longest record up to 5 Hz, or to what all records hold; below 0 where
/// no frequency is left.
Line strongest_line(const Fit& fit, const event::WhitenedEvents& events);

}  // namespace swingbank::validate::fit
