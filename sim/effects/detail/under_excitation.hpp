#pragma once
// Common part of the under-excitation limiters UEL1 and UEL2: PI regulator and two lead-lags. The input is
// the distance beyond the characteristic; the output is added to the voltage error.
#include <fmt/format.h>

#include <string>
#include <utility>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"

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
    const auto bad = [&](bool wrong, std::string what, std::string why, std::string remedy) {
      if (wrong) problems.add(std::move(what), where, std::move(why), std::move(remedy));
    };
    const auto says = [&](int i) { return fmt::format("{} = {:g}", M::parameters[i].symbol, p[i]); };
    bad(p[M::KUF] != 0.0, says(M::KUF),
        fmt::format("the exciter's rate feedback is not available to {}", M::name), "give KUF = 0");
    bad(p[M::VULMIN] != 0.0, says(M::VULMIN) + " pu",
        fmt::format("{} adds to the voltage error and must be zero within its characteristic; a takeover "
                    "gate is not modelled",
                    M::name),
        "give VULMIN = 0");
    for (int i : {M::KUI, M::KUL})
      bad(!(p[i] >= 0), says(i), "the limiter would act in the wrong direction", "give a value >= 0");
    for (int i : {M::TU2, M::TU4})
      bad(!(p[i] >= 0), says(i) + " s", "a time constant cannot be negative", "give a value >= 0");
    bad(!(p[M::VUIMIN] <= 0.0 && p[M::VUIMAX] >= 0.0),
        fmt::format("{} pu with {} pu", says(M::VUIMIN), says(M::VUIMAX)),
        "the integrator starts at VUIMIN and only raises the voltage", "give VUIMIN <= 0 <= VUIMAX");
    bad(!(p[M::VULMAX] >= 0.0), says(M::VULMAX) + " pu", "the limits cross", "give VULMAX >= 0");
  }
};

}  // namespace swingbank::sim::effects::shared
