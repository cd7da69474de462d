#pragma once
// Common mistakes in the columns V, theta, P and Q, tested at the voltage steps of a record.
#include <functional>
#include <string>
#include <vector>

#include "base/constants.hpp"
#include "validate/check/check.hpp"

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
  constexpr double kThousand = 1e3;
  static const std::vector<Mistake> list = {
      {"swapped_channels", "with P and Q exchanged the steps are consistent",
       "exchange the columns of P and Q",
       [](const Reading& x) {
         return Reading{x.V, x.theta, x.Q, x.P};
       }},
      {"power_sign", "with the signs of P and Q reversed the steps are consistent",
       "reverse the signs of P and Q with --columns (P=-NAME,Q=-NAME)",
       [](const Reading& x) {
         return Reading{x.V, x.theta, -x.P, -x.Q};
       }},
      {"angle_unit", "with theta in degrees the steps are consistent", "name the column theta_deg",
       [](const Reading& x) {
         return Reading{x.V, x.theta * constants::degree, x.P, x.Q};
       },
       0.015, 0.1},  // an angle that hardly steps fits in either unit
      // If the angle is 57 times too small, the steps of V alone give a low residual, so the limit `sound` is
      // low. This is safe: the correction makes the angle of a sound record 57 times too large, which never
      // fits.
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
      {"power_unit", "with P a thousand times as large the steps are consistent",
       "check the unit in the column's name: kW, MW or GW",
       [](const Reading& x) {
         return Reading{x.V, x.theta, kThousand * x.P, x.Q};
       }},
      {"power_unit", "with Q a thousand times as large the steps are consistent",
       "check the unit in the column's name: kvar, Mvar or Gvar",
       [](const Reading& x) {
         return Reading{x.V, x.theta, x.P, kThousand * x.Q};
       }},
  };
  return list;
}

/// Returns t, V, theta, P and Q of a record, reinterpreted from the columns as written.
inline record::Record reinterpreted(const record::Record& r, const Reinterpret& reinterpret) {
  record::Record other;
  other.t = r.t;
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const Reading x = reinterpret({r.V[k], r.written_angle()[k], r.P[k], r.Q[k]});
    other.V.push_back(x.V);
    other.theta.push_back(x.theta);
    other.P.push_back(x.P);
    other.Q.push_back(x.Q);
  }
  return other;
}

/// Mistake that makes the steps of a record consistent, with the residual share of its correction.
struct Explanation {
  const Mistake* mistake;
  double residual;
};
/// Returns the likeliest explanation: the first one, unless another has less than half its residual. Mistakes
/// earlier in the list are more common. Returns null if there is none.
inline const Explanation* likeliest(const std::vector<Explanation>& explanations) {
  const Explanation* best = nullptr;
  for (const Explanation& e : explanations)
    if (e.residual < (best ? best->residual : 1) / 2) best = &e;
  return best;
}
/// Returns the refusal of a record with inconsistent steps. Its explanations have a residual below twice that
/// of the best one.
inline Finding inconsistent_steps(const std::string& record, const Explanation& best,
                                  const std::vector<Explanation>& explanations) {
  const auto finding = [&](const Mistake& m) {
    return Finding{
        m.kind,
        Severity::refuse,
        {"steps of voltage and current that are inconsistent with a machine", record, m.why, m.remedy}};
  };
  Finding refusal = finding(*best.mistake);
  refusal.explanations = {finding(*best.mistake)};
  for (const Explanation& e : explanations)
    if (e.mistake != best.mistake && e.residual < 2 * best.residual)
      refusal.explanations.push_back(finding(*e.mistake));
  return refusal;
}

}  // namespace swingbank::validate::check
