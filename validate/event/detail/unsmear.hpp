#pragma once
// Brings back the voltage of a short fault that an instrument's filter has smeared. Where fewer than three
// samples of a segment are free of the jumps beside it, extrapolation does not know the segment's voltage.
// The smeared samples do know it: they are averages of what lies before, within and after the segment, and
// the weights of these averages are known but for a width.
#include <vector>

#include "validate/event/event.hpp"

namespace swingbank::validate::event {

/// The averaging window of a filter: even, its integral 1.
struct FilterWindow {
  enum class Shape { triangle, box } shape = Shape::triangle;
  double half = 0;  ///< how far the window reaches to either side [s]; 0: none found
};

/// Fills short segments of the events' clean records with the voltage whose average gives the smeared
/// samples, and places their switchings. One window is common to all events, and the one that leaves least is
/// taken. Where no window answers to within a few times the noise of V and theta, only segments without a
/// clean sample are filled, so that there is something to play in. Returns the window.
FilterWindow unsmear(std::vector<FitEvent>& events);

}  // namespace swingbank::validate::event
