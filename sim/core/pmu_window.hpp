#pragma once
// Windows of the reference filters of phasor measurement units, classes P and M (IEEE Std C37.118.1-2011,
// Annex C; 2018, Annex D). Shared by the instrument models, which average with them, and by the code that
// inverts them.
#include <cmath>
#include <span>

#include "base/constants.hpp"

namespace swingbank::sim::pmu_window {

/// Half width of the triangular window of class P [cycles].
inline constexpr double kHalfOfP = 1.0;
/// w(t) = 1 - |t| / half for |t| < half. t, half [s].
inline double class_p(double t, double half) { return 1.0 - std::fabs(t) / half; }

/// Reference filter of class M: reporting rate [1/s], cut-off frequency Ffr [Hz], filter order at 16 samples
/// per cycle.
struct MClass {
  double reports, Ffr, order;  ///< reporting rate [1/s]; cut-off frequency [Hz]; order of the filter
  /// Returns half of the window's length [s]; `hz`: system frequency [Hz].
  [[nodiscard]] constexpr double half(double hz) const { return order / (32.0 * hz); }
};
/// Filters of class M at 50 Hz.
inline constexpr MClass kAt50Hz[] = {{10, 1.779, 806}, {25, 4.355, 338}, {50, 7.75, 142}, {100, 14.1, 66}};
/// Filters of class M at 60 Hz.
inline constexpr MClass kAt60Hz[] = {{10, 1.780, 968}, {12, 2.125, 816}, {15, 2.64, 662}, {20, 3.50, 502},
                                     {30, 5.02, 306},  {60, 8.19, 164},  {120, 16.25, 70}};
/// Returns the filters at a system frequency [Hz]; empty at any other than 50 and 60.
inline std::span<const MClass> table(double hz) {
  if (hz == 50.0) return kAt50Hz;
  if (hz == 60.0) return kAt60Hz;
  return {};
}
/// Returns the filter at a system frequency [Hz] and reporting rate [1/s]; nullptr: the standard has none.
inline const MClass* find(double hz, double reports) {
  for (const MClass& row : table(hz))
    if (row.reports == reports) return &row;
  return nullptr;
}
/// w(t) = sin(x) / x (0.54 + 0.46 cos(pi t / half)) for |t| < half, with x = 4 pi Ffr t. t, half [s]; Ffr
/// [Hz].
inline double class_m(double t, double half, double Ffr) {
  const double x = 4.0 * constants::pi * Ffr * t,
               sinc = std::fabs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
  return sinc * (0.54 + 0.46 * std::cos(constants::pi * t / half));
}

}  // namespace swingbank::sim::pmu_window
