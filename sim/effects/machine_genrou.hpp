#pragma once
// GENROU: round-rotor machine, one field and three damper circuits.
//
// Conventions. PSS/E sets the mechanical power: it divides Pm - D w by 1 + w, but not Te. There is no speed
// voltage. Integrated with PSS/E's own time steps, these equations reproduce PSS/E's records psse/GENROU
// within 0.0002 degrees. The error is 0.009 degrees with speed voltage, 0.045 degrees with mechanical torque
// in place of power, and 0.002 degrees without damping. ANDES uses torques and no speed voltage
// (tests/reference/andes).
#include "sim/direct/round_rotor.hpp"
#include "sim/effects/detail/round_rotor.hpp"

namespace swingbank::sim::effects::machine_genrou {

struct Model : shared::RoundRotor<Model, QuadraticSaturation> {
  static constexpr std::string_view name = "GENROU", title = "round-rotor machine, quadratic saturation",
                                    source = "PSS/E GENROU; IEEE Std 1110-2019 model 2.2",
                                    dyr_name = "GENROU";
  static constexpr std::string_view description = R"(
   psi''d = gd1 E'q + (1 - gd1) psi1d          gd1 = (X'' - Xl)/(X'd - Xl)
   psi''q = (1 - gq1) psi2q - gq1 E'd          gq1 = (X'' - Xl)/(X'q - Xl)
   E'' = (-psi''q + j psi''d)(1 + w) exp(j(delta - pi/2)) behind Ra + jX''    (1 + w): speed voltage, not in PSS/E
   Se = B (psi'' - A)^2/psi'' above A, with Se(1.0) = S1.0 and Se(1.2) = S1.2;  S1.0 = 0: no saturation
   Xad Ifd = E'q + (Xd - X'd)(Id - kd td) + psi''d Se      td = psi1d + (X'd - Xl) Id - E'q
   T'do dE'q/dt  = Efd - Xad Ifd                           T''do dpsi1d/dt = -td
   T'qo dE'd/dt  = (Xq - X'q)(Iq - kq tq) - E'd + ks psi''q Se     (T'qo = 0: 10 ms in its place)
   tq = psi2q + (X'q - Xl) Iq + E'd                        T''qo dpsi2q/dt = -tq
   kd = (X'd - X'')/(X'd - Xl)^2   kq = (X'q - X'')/(X'q - Xl)^2   ks = (Xq - Xl)/(Xd - Xl)
   2H dw/dt = Tm - Te - D w   (PSS/E's convention: (Pm - D w)/(1 + w) - Te)      Te = psi''d Iq - psi''q Id
)";
  static std::vector<std::vector<double>> closed_form(const Recording& record, const double* known) {
    std::vector<std::vector<double>> all;
    for (const direct::RoundRotor& r : direct::round_rotor(record, known[Ra], known[Xdpp]))
      all.push_back({r.Tdop, r.Tdopp, r.Tqop, r.Tqopp, r.H, r.D, r.Xd, r.Xq, r.Xdp, r.Xqp, known[Xdpp], r.Xl,
                     r.S10, r.S12, known[Ra]});
    return all;
  }
};

}  // namespace swingbank::sim::effects::machine_genrou
