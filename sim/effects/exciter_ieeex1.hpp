#pragma once
// IEEEX1: rotating direct-current exciter with a lead-lag.
#include "sim/effects/detail/dc_type_one.hpp"

namespace swingbank::sim::effects::exciter_ieeex1 {

struct Model : shared::DcTypeOne<Model> {
  static constexpr std::string_view name = "IEEEX1",
                                    title = "rotating DC exciter, type 1 of 1979 and DC1 of 1981",
                                    source =
                                        "IEEE Committee Report, Excitation system models (1981), DC1; "
                                        "PSS/E IEEEX1; GridPACK and PSLF EXDC1",
                                    dyr_name = "IEEEX1";
  static constexpr std::string_view variant_of = "IEEET1";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ (1 + s TC)/(1 + s TB) ] --> [ KA/(1 + s TA) ] --> Vr
         Vr: [VRMIN, VRMAX], non-windup
  TE dEfd/dt = Vr - KE Efd - Efd Se(Efd)         Vf = s KF/(1 + s TF) Efd
  Efd Se(Efd) = B (Efd - A)^2 above A through (E1, SE1), (E2, SE2); GridPACK uses an exponential instead
  VRMAX = 0 stands for VRMAX = (SE2 + KE) E2 (KE only if positive) and VRMIN = -VRMAX
  KE = 0 stands for KE = VRMAX/(10 Efd) - Se(Efd) at the operating point, so that Vr is a tenth of VRMAX
  A record of EXDC1 in a .dyr has the same columns and is read as this model.
)";
  static constexpr bool ends_at_zero = false;
  static constexpr State states[] = {{"Vm", "pu", "measured voltage", 1.0, -1, -1, {iTR}},
                                     {"leadlag", "pu", "state of the lead-lag", 1.0, -1, -1, {iTB}},
                                     {"Vr", "pu", "regulator output", 1.0, vrmin, vrmax},
                                     {"Efd", "pu", "field voltage"},
                                     {"rate", "pu", "state of the rate feedback", 1.0, -1, -1, {iTF}}};
};

}  // namespace swingbank::sim::effects::exciter_ieeex1
