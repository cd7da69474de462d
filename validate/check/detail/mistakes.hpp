#pragma once
// Common confusions of the four columns, tested if the steps of the record are inconsistent.
#include <functional>
#include <vector>

#include "base/constants.hpp"

namespace swingbank::validate::check {

/// The four columns of a sample under an assumed mistake.
struct Reading {
  double V, theta, P, Q;
};
using Reinterpret = std::function<Reading(const Reading&)>;

/// Mistake whose correction may make inconsistent steps consistent.
struct Mistake {
  const char *kind, *why, *remedy;
  Reinterpret reinterpret;
  double sound = 0.03;  ///< largest residual share with which the correction is accepted
  double turn = 0;      ///< smallest required step of the angle as written [rad]
};
inline const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> list = {
      {"swapped_channels", "with P and Q exchanged they fit", "exchange the columns of P and Q",
       [](const Reading& x) {
         return Reading{x.V, x.theta, x.Q, x.P};
       }},
      {"power_sign", "with P and Q counted out of the machine they fit", "change the sign of P and Q",
       [](const Reading& x) {
         return Reading{x.V, x.theta, -x.P, -x.Q};
       }},
      {"angle_unit", "with theta in degrees they fit", "name the column theta_deg",
       [](const Reading& x) {
         return Reading{x.V, x.theta * constants::degree, x.P, x.Q};
       },
       0.015, 0.1},  // if the angle hardly steps, no angle at all would fit nearly as well
      {"angle_unit", "with theta in radians they fit", "name the column theta_rad",
       [](const Reading& x) {
         return Reading{x.V, x.theta / constants::degree, x.P, x.Q};
       },
       0.006},  // too small an angle is hidden by larger steps of V; too large a one fits no sound record
      {"q_sign", "with the sign of Q changed they fit", "change the sign of Q",
       [](const Reading& x) {
         return Reading{x.V, x.theta, x.P, -x.Q};
       }},
  };
  return list;
}

}  // namespace swingbank::validate::check
