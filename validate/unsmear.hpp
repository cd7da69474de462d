#pragma once
// What an instrument's filter has smeared over a short fault, brought back. Where fewer than three samples of
// a segment are free of the jumps beside it, extrapolation does not know its voltage; the smeared samples do,
// for they are averages of what lies before, within and after, whose weights are known but for a width.
#include <vector>

#include "validate/fit_event.hpp"

namespace swingbank::validate {

/// The averaging window of a filter: even, its integral 1.
struct FilterWindow {
  enum class Shape { triangle, box } shape = Shape::triangle;
  double half = 0;  ///< reaches that far to either side [s]; 0: none found
};

/// Fills short segments of the events' clean records with the voltage that, averaged, gives the smeared
/// samples, and places their switchings. The window is the one, common to all events, that leaves least.
/// Where no window answers to within a few times the noise of V and theta, only segments without a clean
/// sample are filled, so that there is something to play in. Returns the window.
FilterWindow unsmear(std::vector<FitEvent>& events);

}  // namespace swingbank::validate
