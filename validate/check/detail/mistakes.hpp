#pragma once
// Common mistakes in the columns V, theta, P and Q, tested at the voltage steps of a record.
#include <functional>
#include <vector>

#include "base/constants.hpp"

namespace swingbank::validate::check {

/// Values of the four columns in one sample.
struct Reading {
  double V, theta, P, Q;
};
using Reinterpret = std::function<Reading(const Reading&)>;

/// Mistake in the columns, with the correction that makes the steps consistent.
struct Mistake {
  const char *kind, *why, *remedy;
  Reinterpret reinterpret;
  double sound = 0.03;  ///< residual share below which the unchanged record is sound: no mistake is reported
  double turn = 0;      ///< smallest required step of the angle as written [rad]
};
inline const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> list = {
      {"swapped_channels", "with P and Q exchanged the steps are consistent",
       "exchange the columns of P and Q",
       [](const Reading& x) {
         return Reading{x.V, x.theta, x.Q, x.P};
       }},
      {"power_sign", "with P and Q positive out of the machine the steps are consistent",
       "reverse the signs of P and Q with --columns (P=-NAME,Q=-NAME)",
       [](const Reading& x) {
         return Reading{x.V, x.theta, -x.P, -x.Q};
       }},
      {"angle_unit", "with theta in degrees the steps are consistent", "name the column theta_deg",
       [](const Reading& x) {
         return Reading{x.V, x.theta * constants::degree, x.P, x.Q};
       },
       0.015, 0.1},  // an angle that hardly steps fits in either unit
      // Steps of V mask an angle that is 57 times too small, so the limit `sound` is low. A low limit is
      // safe, because an angle that is 57 times too large fits no sound record.
      {"angle_unit", "with theta in radians the steps are consistent", "name the column theta_rad",
       [](const Reading& x) {
         return Reading{x.V, x.theta / constants::degree, x.P, x.Q};
       },
       0.006},
      {"q_sign", "with the sign of Q reversed the steps are consistent",
       "reverse the sign of Q with --columns (Q=-NAME)",
       [](const Reading& x) {
         return Reading{x.V, x.theta, x.P, -x.Q};
       }},
  };
  return list;
}

}  // namespace swingbank::validate::check
