#pragma once
// EXDC2: rotating direct-current exciter whose regulator is fed from the machine's terminal.
#include "sim/effects/detail/dc_type_one.hpp"
#include "sim/effects/detail/limited_lag.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::exciter_exdc2 {

struct Model : shared::DcBehindLeadLag<Model> {
  static constexpr std::string_view name = "EXDC2",
                                    title =
                                        "rotating DC exciter with terminal-fed regulator, type DC2 of 1981",
                                    source =
                                        "IEEE Committee Report, Excitation system models (1981), DC2; "
                                        "IEEE Std 421.5-2005, 5.2, type DC2A; PSS/E EXDC2",
                                    dyr_name = "EXDC2";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ (1 + s TC)/(1 + s TB) ] --> [ KA/(1 + s TA) ] --> Vr
         Vr: [V VRMIN, V VRMAX]; its lag returns to a limit with a time constant of 2 ms, which prevents windup
  TE dEfd/dt = Vr - KE Efd - Efd Se(Efd)         Vf = s KF/(1 + s TF) Efd
  Efd Se(Efd) = B (Efd - A)^2 above A through (E1, SE1), (E2, SE2)
  VRMAX = 0 stands for VRMAX = (SE2 + KE) E2 (KE only if positive) and VRMIN = -VRMAX
  KE = 0 stands for KE = VRMAX/(10 Efd) - Se(Efd) at the operating point, so that Vr is a tenth of VRMAX
)";
  static constexpr bool ends_at_zero = false;
  static constexpr Source defaults_from = literature::andes("EXDC2, commit 29076bd");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      kTR,
      {"KA", "KA", "pu", 100.0, 1.0, 1000.0, kNoNullValue, "regulator gain",
       literature::own("among the case files' 40 to 200")},
      {"TA", "TA", "s", 0.05, 0.0, 10.0, kNoNullValue, "regulator time constant (0: none)",
       literature::griddyn("dynamicsWECC.dyr")},
      {"TB", "TB", "s", 2.0, 0.0, 50.0, kNoNullValue, "lag (0: bypass)",
       literature::own("halves the transient gain; the case files have hardly any lead-lag")},
      {"TC", "TC", "s", 1.0, 0.0, 50.0, kNoNullValue, "lead",
       literature::own("halves the transient gain; the case files have hardly any lead-lag")},
      upper_limit({"VRMAX", "VRMAX", "pu", 7.3, 0.0, 100.0, kNoNullValue,
                   "upper limit of Vr at rated voltage (0: from saturation at E2)"}),
      lower_limit(
          {"VRMIN", "VRMIN", "pu", -7.3, -100.0, 0.0, kNoNullValue, "lower limit of Vr at rated voltage"}),
      kKE,
      kTE,
      {"KF", "KF", "pu", 0.08, 0.0, 1.0, 0.0, "gain of the rate feedback",
       literature::own("among the case files' 0.05 to 0.10")},
      kTF,
      kSwitch,
      kE1,
      kSE1,
      kE2,
      kSE2};
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage"},
      {"leadlag", "pu", "state of the lead-lag"},
      {.name = "Vr", .unit = "pu", .meaning = "regulator output", .bends = true},
      {.name = "Efd", .unit = "pu", .meaning = "field voltage", .bends = true},
      {"rate", "pu", "state of the rate feedback", 1.0, -1, -1, {iTF}}};

  template <class T>
  static T regulator(const T* c, const T* x, const T& u, const T& V, T* dx) {
    return shared::limited_lag(c[iTA], x[Vr], c[gain] * u, V * c[vrmin], V * c[vrmax], dx[Vr]);
  }
  template <class T>
  static std::string hindrance(const T* c, const T& Vr, const T& V) {
    return shared::outside("Vr", Vr, V * c[vrmin], V * c[vrmax], "V VRMIN, V VRMAX");
  }
};

}  // namespace swingbank::sim::effects::exciter_exdc2
