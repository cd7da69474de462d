#pragma once
// Exciter of SEXS and SCRX: a lead-lag and one lag between fixed limits. A Model may append parameters and
// coefficients; its second state is the lag's state.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

template <class Model>
struct SimplifiedExciter {
  static constexpr Slot slot = Slot::exciter;
  enum P { TAoverTB, TB, K, TE, EMIN, EMAX, own_parameters };
  enum C { TA, iTB, gain, iTE, low, high, Vref, own_coefficients };
  enum X { leadlag, output };
  static constexpr Source bounds_from = kBeyondCases;
  static constexpr Parameter kTAoverTB = {"TAoverTB", "TA/TB", "-", 0.1,
                                          0.0,        10.0,    1.0, "ratio of lead to lag time constant"},
                             kTB = {"TB", "TB",  "s",          10.0,
                                    0.0,  100.0, kNoNullValue, "lag time constant (0: none)"},
                             kK = {"K", "K", "pu", 100.0, 0.5, 2000.0, kNoNullValue, "gain"},
                             kTE = {"TE", "TE", "s",          0.1,
                                    0.0,  5.0,  kNoNullValue, "exciter time constant (0: none)"};
  // An error of the lead-lag's state persists for TB and is amplified about 100 times to Efd. An error of Efd
  // itself decays with TE.
  static constexpr State kLeadLag = {"leadlag", "pu", "state of the lead-lag", 20.0, -1, -1, {iTB}};
  static constexpr double kLagWeight = 0.1;

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(Model::name, Model::parameters, p, where, problems);
    values.require_positive({K}, "an exciter needs a gain");
    values.require_times({TB, TE});
    values.require_above(EMAX, EMIN,
                         fmt::format("the range of {} must not be empty", Model::states[output].name));
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[TA] = p[TAoverTB] * p[TB];
    c[iTB] = inverse(p[TB]);
    c[gain] = p[K];
    c[iTE] = inverse(p[TE]);
    c[low] = p[EMIN];
    c[high] = p[EMAX];
  }

 protected:
  template <class T>
  static T limited_output(const T* c, const T* x, const Signals<T>& s, T* dx) {
    const T error = c[Vref] + s.dVref - s.Vc + s.Vs + s.Vlimiter;
    const T y = lead_lag(c[TA], c[iTB], x[leadlag], error, dx[leadlag]);
    return clamp(lag(c[iTE], x[output], c[gain] * y, dx[output]), c[low], c[high]);
  }
  /// Computes the states and the reference for a steady output `out` [pu].
  template <class T>
  static void rest(const T* p, T* c, const Signals<T>& s, const T& out, T* x) {
    x[output] = out;
    x[leadlag] = out / p[K];
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
  }
};

}  // namespace swingbank::sim::effects::shared
