#pragma once
// IEEET2: rotating direct-current exciter with rate feedback of the regulator's output.
#include "sim/effects/detail/rotating_dc.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_ieeet2 {

struct Model : shared::RotatingDc<Model> {
  static constexpr std::string_view name = "IEEET2", title = "rotating DC exciter, type 2 of 1968",
                                    source =
                                        "IEEE Committee Report, Computer representation of excitation "
                                        "systems (1968), type 2; PSS/E IEEET2",
                                    dyr_name = "IEEET2";
  static constexpr std::string_view variant_of = "IEEET1";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ KA/(1 + s TA) ] --> Vr, [VRMIN, VRMAX] non-windup
  TE dEfd/dt = Vr - KE Efd - Efd Se(Efd)         Vf = s KF/((1 + s TF1)(1 + s TF2)) Vr
  Efd Se(Efd) = B (Efd - A)^2 above A through (E1, SE1), (E2, SE2)
  VRMAX = 0 stands for VRMAX = (SE2 + KE) E2 (KE only if positive) and VRMIN = -VRMAX
  KE = 0 stands for KE = VRMAX/(10 Efd) - Se(Efd) at the operating point, so that Vr is a tenth of VRMAX
)";
  enum P { TR, KA, TA, VRMAX, VRMIN, KE, TE, KF, TF, TF2, E1, SE1, E2, SE2 };
  static constexpr Source defaults_from = literature::andes("IEEET1, commit 066781b");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      kTR,
      kKA,
      {"TA", "TA", "s", 0.1, 0.01, 10.0, kNoNullValue, "regulator time constant",
       literature::own("among IEEET1's 0.001 to 0.2 s")},
      kVRMAX,
      kVRMIN,
      kKE,
      kTE,
      kKF,
      {"TF1", "TF1", "s", 1.0, 0.02, 20.0, kNoNullValue,
       "first time constant of the rate feedback (0 only if KF = 0)"},
      {"TF2", "TF2", "s", 0.8, 0.0, 20.0, kNoNullValue, "second time constant of the rate feedback (0: none)",
       literature::own("that of the exciter, which it represents")},
      kE1,
      kSE1,
      kE2,
      kSE2};
  static constexpr int dyr_columns[] = {TR, KA, TA, VRMAX, VRMIN, KE, TE, KF, TF, TF2, E1, SE1, E2, SE2};
  enum C { iTR, gain, iTA, vrmax, vrmin, self, iTE, feedback, iTF, satA, satB, iTF2, Vref, coefficients };
  enum X { Vm, Vr, Efd, rate, slow };
  static constexpr State states[] = {{"Vm", "pu", "measured voltage", 1.0, -1, -1, {iTR}},
                                     {"Vr", "pu", "regulator output", 1.0, vrmin, vrmax},
                                     {"Efd", "pu", "field voltage"},
                                     {"rate", "pu", "state of the rate feedback", 1.0, -1, -1, {iTF}},
                                     {"slow", "pu", "rate feedback, lagged", 1.0, -1, -1, {iTF2}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    RotatingDc::check_with({TR, TF2}, values, p);
    values.require_positive({TA}, "the rate feedback needs a lagged Vr");
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    RotatingDc::prepare(p, conventions, c);
    c[iTF2] = inverse(p[TF2]);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T vr = clamp(x[Vr], c[vrmin], c[vrmax]);
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T fed = c[feedback] * washout(c[iTF], x[rate], vr, dx[rate]);
    const T error = c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter - lag(c[iTF2], x[slow], fed, dx[slow]);
    dx[Vr] = (c[gain] * error - x[Vr]) * c[iTA];
    excite(c, x, vr, s, dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const std::string why = steady_exciter(p, c, s, x);
    if (!why.empty()) return why;
    x[rate] = x[Vr];
    x[slow] = T(0.0);
    c[Vref] = x[Vr] / p[KA] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_ieeet2
