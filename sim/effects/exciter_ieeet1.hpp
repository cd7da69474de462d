#pragma once
// IEEET1: rotating direct-current exciter.
#include "sim/effects/detail/rotating_dc.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::exciter_ieeet1 {

struct Model : shared::RotatingDc<Model> {
  static constexpr std::string_view name = "IEEET1", title = "rotating DC exciter, type 1 of 1968",
                                    source =
                                        "IEEE Committee Report, Computer representation of excitation "
                                        "systems (1968), type 1; PSS/E IEEET1",
                                    dyr_name = "IEEET1";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ KA/(1 + s TA) ] --> Vr, [VRMIN, VRMAX] non-windup
  TE dEfd/dt = Vr - KE Efd - Efd Se(Efd)         Vf = s KF/(1 + s TF) Efd
  Efd Se(Efd) = B (Efd - A)^2 above A through (E1, SE1), (E2, SE2)
  VRMAX = 0 stands for VRMAX = (SE2 + KE) E2 (KE only if positive) and VRMIN = -VRMAX
  KE = 0 stands for KE = VRMAX/(10 Efd) - Se(Efd) at the operating point, so that Vr is a tenth of VRMAX
)";
  enum P { TR, KA, TA, VRMAX, VRMIN, KE, TE, KF, TF, SWITCH, E1, SE1, E2, SE2 };
  static constexpr Source defaults_from = literature::andes("IEEET1, commit 066781b");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      kTR,
      kKA,
      {"TA", "TA", "s", 0.1, 0.0, 10.0, kNoNullValue, "regulator time constant (0: none)",
       literature::own("among the case files' 0.001 to 0.2 s")},
      kVRMAX,
      kVRMIN,
      kKE,
      kTE,
      kKF,
      kTF,
      kSwitch,
      kE1,
      kSE1,
      kE2,
      kSE2};
  static constexpr int dyr_columns[] = {TR, KA, TA, VRMAX, VRMIN, KE, TE, KF, TF, SWITCH, E1, SE1, E2, SE2};
  enum C { iTR, gain, iTA, vrmax, vrmin, self, iTE, feedback, iTF, satA, satB, Vref, coefficients };
  enum X { Vm, Vr, Efd, rate };
  static constexpr State states[] = {{"Vm", "pu", "measured voltage"},
                                     {"Vr", "pu", "regulator output", 1.0, vrmin, vrmax},
                                     {"Efd", "pu", "field voltage"},
                                     {"rate", "pu", "state of the rate feedback", 1.0, -1, -1, {iTF}}};

  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T error = voltage_error(c, x, s, dx);
    const T vr = clamp(lag(c[iTA], x[Vr], c[gain] * error, dx[Vr]), c[vrmin], c[vrmax]);
    excite(c, x, vr, s, dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const std::string why = steady_exciter(p, c, s, x);
    if (!why.empty()) return why;
    c[Vref] = x[Vr] / p[KA] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_ieeet1
