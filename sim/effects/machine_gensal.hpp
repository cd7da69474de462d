#pragma once
// GENSAL: salient-pole machine, one field circuit, one damper circuit in each axis.
//
// Conventions are those of GENROU. Integrated with PSS/E's own time steps, the equations reproduce voltages
// and speed of PSS/E's record psse/EXST1 (D = 4) within 0.03 % of their swing. The error is 3 % with speed
// voltage, 1.8 % with mechanical torque in place of power, and 15 % without damping. The angle of the record
// psse_powersimulationsdynamics/GENSAL (D = 0) is reproduced within 0.0002 degrees over 10 s. The error is
// 0.0009 degrees with speed voltage and 0.017 degrees with torque.
#include "sim/effects/detail/salient_pole.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::machine_gensal {

struct Model : shared::SalientPole {
  static constexpr std::string_view name = "GENSAL", title = "salient-pole machine, quadratic saturation",
                                    source = "PSS/E GENSAL; IEEE Std 1110-2019 model 2.1; Kundur (1994), 5.1",
                                    dyr_name = "GENSAL";
  static constexpr std::string_view description = R"(
   psi''d = gd1 E'q + (1 - gd1) psi1d          gd1 = (X'' - Xl)/(X'd - Xl)
   E'' = (-psi''q + j psi''d)(1 + w) exp(j(delta - pi/2)) behind Ra + jX''    (1 + w): speed voltage, not in PSS/E
   E'q Se = B (E'q - A)^2 above A, with Se(1.0) = S1.0 and Se(1.2) = S1.2 (d axis only);  S1.0 = 0: none
   Xad Ifd = E'q (1 + Se) + (Xd - X'd)(Id - kd td)         td = psi1d + (X'd - Xl) Id - E'q
   T'do dE'q/dt   = Efd - Xad Ifd                          kd = (X'd - X'')/(X'd - Xl)^2
   T''do dpsi1d/dt = -td                                   T''qo dpsi''q/dt = -psi''q - (Xq - X'') Iq
   2H dw/dt = Tm - Te - D w   (PSS/E's convention: (Pm - D w)/(1 + w) - Te)      Te = psi''d Iq - psi''q Id
)";
  static constexpr auto parameters =
      parameters_with("saturation factor at 1.0 pu E'q (0: none)", "saturation factor at 1.2 pu E'q");
  enum { A = circuits, B, coefficients };
  enum { scratch = rotor };

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    check_circuits(values, p);
    check_saturation<QuadraticSaturation>(values, p);
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    prepare_circuits(p, conventions, c);
    quadratic_saturation(p[S10], p[S12], c[A], c[B]);
  }
  /// Returns E'q Se(E'q).
  template <class T>
  static T saturated(const T* c, const T& e) {
    return c[B] * square(positive_part(e - c[A]));
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    stator(c, x, m, s);
    s.Ifd = unsaturated_field(c, x, m) + saturated(c, x[Eqp]);
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    rotor_derivative(c, x, m, s, x[psi2q], dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::atan2;
    // The unsaturated q axis lies along V + (Ra + jXq) I.
    x[delta] = atan2(s.Vi + p[Ra] * s.Ii + p[Xq] * s.Ir, s.Vr + p[Ra] * s.Ir - p[Xq] * s.Ii);
    x[speed] = T(0.0);
    T sd, cd;
    sincos(x[delta], sd, cd);
    const T id = s.Ir * sd - s.Ii * cd, iq = s.Ir * cd + s.Ii * sd;
    const T vq = s.Vr * cd + s.Vi * sd;
    const T flux_d = vq + p[Ra] * iq + p[Xdpp] * id;
    x[psi2q] = T(0.0) - c[dXq] * iq;
    x[Eqp] = flux_d + (p[Xdp] - p[Xdpp]) * id;
    x[psi1d] = x[Eqp] - c[xdl] * id;
    s.Efd = x[Eqp] + c[dXd] * id + saturated(c, x[Eqp]);
    s.Tm = flux_d * iq - x[psi2q] * id;
    return {};
  }
};

}  // namespace swingbank::sim::effects::machine_gensal
