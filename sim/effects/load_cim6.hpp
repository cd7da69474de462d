#pragma once
// CIM6: the motor of CIM5 with the load torque polynomial from the .dyr.
#include "sim/effects/load_cim5.hpp"

namespace swingbank::sim::effects::load_cim6 {

struct Model : load_cim5::Model {
  static constexpr std::string_view name = "CIM6",
                                    title = "motor of CIM5 with the load torque polynomial of the .dyr",
                                    source = "PSS/E CIM6BL; equations as of CIM5", dyr_name = "CIM6BL";
  static constexpr std::string_view description = R"(
  The motor of CIM5 (swingbank effects CIM5) with the load torque polynomial of the .dyr:

  TL = T0 (A w^2 + B w + C0 + D w^E), w = 1 - slip >= 0, T0 such that the motor draws the load's P
  Its undervoltage relay (VI > 0) is not modelled.
)";
  static constexpr int dyr_columns[] = {IT,    Ra,    Xa, Xm, R1, X1, R2, X2, E1, S1, E2, S2,
                                        Mbase, Pmult, H,  VI, TI, TB, A,  B,  D,  E,  C0, Tnom};
};

}  // namespace swingbank::sim::effects::load_cim6
