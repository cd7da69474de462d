#pragma once
// GENROE: round-rotor machine, one field and three damper circuits, exponential saturation.
//
// Conventions are those of GENROU. Integrated with PSS/E's own time steps and without damping, the equations
// reproduce PSS/E's records psse_powersimulationsdynamics/GENROE within 0.0002 degrees. Their .dyr has D =
// 0.05, which gives an error of 0.002 degrees; no available record verifies the damping. The error is 0.009
// degrees with speed voltage and 0.047 degrees with mechanical torque in place of power.
#include "sim/effects/detail/round_rotor.hpp"

namespace swingbank::sim::effects::machine_genroe {

struct Model : shared::RoundRotor<Model, ExponentialSaturation> {
  static constexpr std::string_view name = "GENROE", title = "round-rotor machine, exponential saturation",
                                    source = "PSS/E GENROE; IEEE Std 1110-2019 model 2.2",
                                    dyr_name = "GENROE";
  static constexpr std::string_view description = R"(
   psi''d = gd1 E'q + (1 - gd1) psi1d          gd1 = (X'' - Xl)/(X'd - Xl)
   psi''q = (1 - gq1) psi2q - gq1 E'd          gq1 = (X'' - Xl)/(X'q - Xl)
   E'' = (-psi''q + j psi''d)(1 + w) exp(j(delta - pi/2)) behind Ra + jX''    (1 + w): speed voltage, not in PSS/E
   Se = S1.0 psi''^x, x = ln(S1.2/S1.0)/ln 1.2: Se(1.2) = S1.2;  S1.0 = 0: no saturation
   Xad Ifd = E'q + (Xd - X'd)(Id - kd td) + psi''d Se      td = psi1d + (X'd - Xl) Id - E'q
   T'do dE'q/dt  = Efd - Xad Ifd                           T''do dpsi1d/dt = -td
   T'qo dE'd/dt  = (Xq - X'q)(Iq - kq tq) - E'd + ks psi''q Se     (T'qo = 0: 10 ms in its place)
   tq = psi2q + (X'q - Xl) Iq + E'd                        T''qo dpsi2q/dt = -tq
   kd = (X'd - X'')/(X'd - Xl)^2   kq = (X'q - X'')/(X'q - Xl)^2   ks = (Xq - Xl)/(Xd - Xl)
   2H dw/dt = Tm - Te - D w   (PSS/E's convention: (Pm - D w)/(1 + w) - Te)      Te = psi''d Iq - psi''q Id
)";
};

}  // namespace swingbank::sim::effects::machine_genroe
