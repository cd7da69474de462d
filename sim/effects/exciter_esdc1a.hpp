#pragma once
// ESDC1A: rotating direct-current exciter with a lower limit of zero for the field voltage.
#include "sim/effects/detail/dc_type_one.hpp"

namespace swingbank::sim::effects::exciter_esdc1a {

struct Model : shared::DcTypeOne<Model> {
  static constexpr std::string_view name = "ESDC1A", title = "rotating DC exciter, type DC1A",
                                    source = "IEEE Std 421.5-2005, 5.1, type DC1A; PSS/E ESDC1A",
                                    dyr_name = "ESDC1A";
  static constexpr std::string_view variant_of = "IEEET1";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ (1 + s TC)/(1 + s TB) ] --> [ KA/(1 + s TA) ] --> Vr
         Vr: [VRMIN, VRMAX], non-windup
  TE dEfd/dt = Vr - KE Efd - Efd Se(Efd), Efd >= 0 non-windup         Vf = s KF/(1 + s TF) Efd
  Efd Se(Efd) = B (Efd - A)^2 above A through (E1, SE1), (E2, SE2)
  VRMAX = 0 stands for VRMAX = (SE2 + KE) E2 (KE only if positive) and VRMIN = -VRMAX
  KE = 0 stands for KE = VRMAX/(10 Efd) - Se(Efd) at the operating point, so that Vr is a tenth of VRMAX
  An under-excitation limiter adds to the error (Vlimiter); the gate after the lead-lag is not modelled.
)";
  static constexpr bool ends_at_zero = true;
  static constexpr State states[] = {{"Vm", "pu", "measured voltage", 1.0, -1, -1, {iTR}},
                                     {"leadlag", "pu", "state of the lead-lag", 1.0, -1, -1, {iTB}},
                                     {"Vr", "pu", "regulator output", 1.0, vrmin, vrmax},
                                     {"Efd", "pu", "field voltage", 1.0, none, -1},
                                     {"rate", "pu", "state of the rate feedback", 1.0, -1, -1, {iTF}}};
};

}  // namespace swingbank::sim::effects::exciter_esdc1a
