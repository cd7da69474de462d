#pragma once
// Common part of the under-excitation limiters UEL1 and UEL2: PI regulator and two lead-lags. The input is
// the distance beyond the characteristic; the output is added to the voltage error.
#include <fmt/format.h>

#include <string>
#include <utility>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

/// (KUL + KUI/s), two lead-lags and limits of the output. A Model has the parameters KUI, KUL, KUF, VUIMAX,
/// VUIMIN, TU1 to TU4, VULMAX, VULMIN, the coefficients integral to bottom and the states Vui, lead1 and
/// lead2.
template <class Model>
struct UnderExcitation {
  template <class T>
  static void prepare(const T* p, T* c) {
    using M = Model;
    c[M::integral] = p[M::KUI];
    c[M::proportional] = p[M::KUL];
    c[M::vimax] = p[M::VUIMAX];
    c[M::vimin] = p[M::VUIMIN];
    c[M::t1] = p[M::TU1];
    c[M::it2] = inverse(p[M::TU2]);
    c[M::t3] = p[M::TU3];
    c[M::it4] = inverse(p[M::TU4]);
    c[M::top] = p[M::VULMAX];
    c[M::bottom] = p[M::VULMIN];
  }
  /// Returns the output for the error e, positive beyond the characteristic [pu].
  template <class T>
  static T output(const T* c, const T* x, const T& e, T* dx) {
    using M = Model;
    dx[M::Vui] = c[M::integral] * e;
    const T u = clamp(x[M::Vui], c[M::vimin], c[M::vimax]) + c[M::proportional] * e;
    const T a = lead_lag(c[M::t1], c[M::it2], x[M::lead1], u, dx[M::lead1]);
    return clamp(lead_lag(c[M::t3], c[M::it4], x[M::lead2], a, dx[M::lead2]), c[M::bottom], c[M::top]);
  }
  /// Computes the steady states for e <= 0, with the integrator at its lower limit.
  template <class T>
  static void rest(const T* p, const T& e, T* x) {
    using M = Model;
    x[M::Vui] = p[M::VUIMIN];
    x[M::lead1] = x[M::lead2] = p[M::VUIMIN] + p[M::KUL] * e;
  }

  static void check(const double* p, const std::string& where, Problems& problems) {
    using M = Model;
    const shared::ValueCheck values(M::name, M::parameters, p, where, problems);
    values.refuse(p[M::KUF] != 0.0, M::KUF,
                  fmt::format("the exciter's rate feedback is not available to {}", M::name), "give KUF = 0");
    values.refuse(
        p[M::VULMIN] != 0.0, M::VULMIN,
        fmt::format("the output of {} is added to the voltage error and must be 0 within the characteristic; "
                    "a takeover gate is not modelled",
                    M::name),
        "give VULMIN = 0");
    values.refuse_negative({M::KUI, M::KUL}, "the limiter would act in the wrong direction");
    values.require_times({M::TU2, M::TU4});
    values.refuse(!(p[M::VUIMIN] <= 0.0 && p[M::VUIMAX] >= 0.0), values.text(M::VUIMIN, M::VUIMAX),
                  "the integrator starts at VUIMIN and only raises the voltage",
                  "give VUIMIN <= 0 <= VUIMAX");
    values.refuse_negative({M::VULMAX}, "the limits cross");
  }
};

}  // namespace swingbank::sim::effects::shared
