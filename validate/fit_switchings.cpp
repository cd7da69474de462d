#include <algorithm>
#include <cmath>

#include "validate/play_in.hpp"

namespace swingbank::validate {
namespace {

/// Smallest of f on [low, high] to within `width`, for f with one valley there.
template <class F>
double golden_section(F f, double low, double high, double width) {
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  double a = high - ratio * (high - low), b = low + ratio * (high - low), fa = f(a), fb = f(b);
  while (high - low > width) {
    if (fa < fb) {
      high = b, b = a, fb = fa;
      fa = f(a = high - ratio * (high - low));
    } else {
      low = a, a = b, fa = fb;
      fb = f(b = low + ratio * (high - low));
    }
  }
  return (low + high) / 2;
}

}  // namespace

std::vector<Switching> fit_switchings(const sim::Plant& plant, const sim::Conventions& conventions,
                                      const Record& record, std::vector<Switching> switchings,
                                      const PlayInOptions& options) {
  if (std::ranges::all_of(switchings, [](const Switching& s) { return s.uncertainty == 0; }))
    return switchings;
  PlayInOptions until = options;
  until.until = std::min(options.until, switchings.back().time + 1.0);
  until.tolerance = std::max(options.tolerance, 1e-8);  // far below the noise of any record
  const double edge = 1e-3 * record.step();             // an instant on a sample would change sides with it
  const std::vector<Switching> found = switchings;
  const auto misfit = [&](const std::vector<Switching>& at) {
    const Playback back = play_in(plant, conventions, record, VoltageCurve(record, at), until);
    double sum = 0;
    for (std::size_t k = 0; k < back.P.size(); ++k)
      sum += std::pow(back.P[k] - record.P[k], 2) + std::pow(back.Q[k] - record.Q[k], 2);
    return sum;
  };
  for (int sweep = 0; sweep < 3;
       ++sweep) {  // the instants hardly depend on each other: the third moves nothing visible
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (found[i].uncertainty == 0) continue;
      const auto at_time = [&](double t) {
        auto moved = switchings;
        moved[i].time = t;
        return misfit(moved);
      };
      switchings[i].time = golden_section(at_time, found[i].time - found[i].uncertainty + edge,
                                          found[i].time + found[i].uncertainty - edge, edge);
    }
  }
  return switchings;
}

}  // namespace swingbank::validate
