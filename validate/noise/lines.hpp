#pragma once
// Detection of a steady oscillation in a fit's residual that is too small to show in chi2 or in slow means.
#include "validate/noise/event_fit.hpp"

namespace swingbank::validate::noise {

/// An oscillation of one frequency, with its own amplitude and phase in each event.
struct Line {
  playin::Output channel = playin::Output::P;  ///< channel in which it was found
  double frequency = 0;                        ///< [Hz]
  /// Reduction of chi2, minus the penalty for the amplitudes and for the number of examined frequencies and
  /// channels. It is usually negative if the residual is only noise.
  double explains = 0;
};
/// Returns the oscillation with the largest `explains`. The periodogram of white noise is exponentially
/// distributed and independent between frequencies, so the periodograms of several events add (J. Follum, J.
/// W. Pierre, IEEE Trans. Power Syst. 31, 2016, p. 2423). The lowest frequency has two periods in the longest
/// record. The highest is 5 Hz or 80 % of the lowest Nyquist frequency, whichever is lower. If the range is
/// empty, `explains` is 0.
Line strongest_line(const std::vector<EventFit>& fits, const WhitenedEvents& events);

}  // namespace swingbank::validate::noise
