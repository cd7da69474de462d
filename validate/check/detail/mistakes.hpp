#pragma once
// Ways in which the four columns of a record get confused, tried where its jumps make no sense as they are.
#include <functional>
#include <vector>

#include "base/constants.hpp"

namespace swingbank::validate::check {

/// One way to read the four columns of a sample: what is tried for the likely mistake.
struct Reading {
  double V, theta, P, Q;
};
using Reinterpret = std::function<Reading(const Reading&)>;

/// Readings that would make sense of jumps which make none as they are.
struct Mistake {
  const char *kind, *why, *remedy;
  Reinterpret reinterpret;
  double sound = 0.03;  ///< share left over up to which the record is taken as it is
  double turn = 0;      ///< the angle as written must jump by this at least [rad]
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
       0.015, 0.1},  // where it hardly jumps, no angle at all would fit nearly as well
      {"angle_unit", "with theta in radians they fit", "name the column theta_rad",
       [](const Reading& x) {
         return Reading{x.V, x.theta / constants::degree, x.P, x.Q};
       },
       0.006},  // too small an angle hides where V jumps more; too large a one fits no sound record
      {"q_sign", "with the sign of Q changed they fit", "change the sign of Q",
       [](const Reading& x) {
         return Reading{x.V, x.theta, x.P, -x.Q};
       }},
  };
  return list;
}

}  // namespace swingbank::validate::check
