#pragma once
// Common part of the over-excitation limiters MAXEX1 and MAXEX2: inverse-time characteristic through three
// points, and a timer that latches when it expires.
#include <fmt/format.h>

#include <string>
#include <utility>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

/// Time constant of the field voltage measurement [s]. It avoids an algebraic loop, because the field voltage
/// of a static exciter follows the limiter's output without delay. PSS/E uses the value of the previous step.
inline constexpr double kFieldVoltageLag = 0.01;

/// Parameters of a Model in this order, starting with EFDRATED.
enum InverseTimePoint { rated, efd1, time1, efd2, time2, efd3, time3, efddes, gain_of_it, vlow };
inline constexpr Parameter kPickup{
    "EFD1", "EFD1", "-", 1.1, 0.5, 5.0, kNoNullValue, "pickup, relative to rated", kAsEffect, kNoCases};
inline constexpr Parameter kTimeAtPickup{"TIME1",
                                         "TIME1",
                                         "s",
                                         60.0,
                                         0.1,
                                         1000.0,
                                         kNoNullValue,
                                         "operating time at EFD1",
                                         literature::own("half of CIM's 120 s"),
                                         kNoCases};
inline constexpr Parameter kMiddle{"EFD2",
                                   "EFD2",
                                   "-",
                                   1.25,
                                   0.5,
                                   5.0,
                                   kNoNullValue,
                                   "middle point, relative to rated",
                                   literature::own("between its neighbours; CIM has 1.2"),
                                   kNoCases};
inline constexpr Parameter kTimeAtMiddle{"TIME2",
                                         "TIME2",
                                         "s",
                                         30.0,
                                         0.1,
                                         1000.0,
                                         kNoNullValue,
                                         "operating time at EFD2",
                                         literature::own("half of TIME1; CIM has 40 s"),
                                         kNoCases};
inline constexpr Parameter kUpper{
    "EFD3", "EFD3", "-", 1.5, 0.5, 10.0, kNoNullValue, "upper point, relative to rated", kAsEffect, kNoCases};
inline constexpr Parameter kTimeAtUpper{"TIME3",   "TIME3", "s",          15.0,
                                        0.01,      1000.0,  kNoNullValue, "operating time at EFD3 and above",
                                        kAsEffect, kNoCases};
inline constexpr Parameter kLowest =
    lower_limit({"VLOW", "VLOW", "pu", -0.1, -10.0, 0.0, kNoNullValue, "lower limit of the output",
                 literature::own("a tenth of rated voltage"), kNoCases});

/// Inverse-time characteristic and timer with `size` coefficients; p and c point to its first parameter and
/// coefficient in a Model.
struct InverseTime {
  enum { irated, i1, i2, i3, t1, t2, slope12, slope23, size };
  static constexpr double kOperated = 1.0;      ///< value of the expired timer
  static constexpr double kOperatedFor = 2.0;   ///< final value of the timer, which rounding cannot reset
  static constexpr double kTimerReset = -10.0;  ///< reset rate of the timer below the pickup [1/s]

  template <class T>
  static void prepare(const T* p, T* c) {
    c[irated] = T(1.0) / p[rated];
    c[i1] = p[efd1];
    c[i2] = p[efd2];
    c[i3] = p[efd3];
    c[t1] = p[time1];
    c[t2] = p[time2];
    c[slope12] = (p[time2] - p[time1]) / (p[efd2] - p[efd1]);
    c[slope23] = (p[time3] - p[time2]) / (p[efd3] - p[efd2]);
  }
  /// Returns the operating time [s] at a quantity i >= pickup [relative to rated].
  template <class T>
  static T operating_time(const T* c, const T& i) {
    const T at = clamp(i, c[i1], c[i3]);
    return select(at < c[i2], c[t1] + c[slope12] * (at - c[i1]), c[t2] + c[slope23] * (at - c[i2]));
  }
  /// Returns the timer's derivative [1/s]; `limited`: limited quantity [pu]. After expiry the timer moves
  /// away from 1, so that rounding in the integrator cannot reset it.
  template <class T>
  static T pace(const T* c, const T& timer, const T& limited) {
    const T one(kOperated), i = limited * c[irated];
    return select(one <= timer, one, select(c[i1] < i, one / operating_time(c, i), T(kTimerReset) * timer));
  }

  /// Guards at discontinuities of the derivatives: the timer's expiry and, before the expiry, the pickup.
  static constexpr int guards = 2;
  template <class T>
  static void guard(const T* c, const T& timer, const T& limited, T* g) {
    const T one(kOperated);
    g[0] = timer - one;
    g[1] = select(one <= timer, one, limited * c[irated] - c[i1]);
  }

  /// Checks the values. `first`: parameter EFDRATED; `limited`: the limited quantity.
  static void check(const ValueCheck& values, const double* p, int first, std::string_view limited) {
    values.require_divisors({first + rated});
    values.refuse(!(p[efd1] < p[efd2] && p[efd2] < p[efd3]),
                  values.text(first + efd1, first + efd2, first + efd3),
                  "the points of the characteristic must ascend", "give EFD1 < EFD2 < EFD3");
    values.refuse(!(p[time1] >= p[time2] && p[time2] >= p[time3] && p[time3] > 0),
                  values.text(first + time1, first + time2, first + time3),
                  fmt::format("the operating time must not rise with the {}", limited),
                  "give TIME1 >= TIME2 >= TIME3 > 0");
    values.refuse_negative({first + gain_of_it}, "the loop would be unstable");
    values.refuse_positive({first + vlow}, "the limiter can only lower the voltage");
  }
  /// Returns the reason if the present value `now` [pu] of the limited quantity exceeds the pickup, or "".
  template <class T>
  static std::string beyond_pickup(const T* p, std::string_view model, std::string_view limited, double now) {
    const double most = value_of(p[efd1]) * value_of(p[rated]);
    if (now <= most) return {};
    return fmt::format(
        "at the operating point {} = {:.4f} pu exceeds the pickup EFD1 EFDRATED = {:.4f} pu; the {} timer would "
        "start at t = 0, so no steady state exists",
        limited, now, most, model);
  }
};

}  // namespace swingbank::sim::effects::shared
