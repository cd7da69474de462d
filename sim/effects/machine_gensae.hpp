#pragma once
// GENSAE: salient-pole machine, one field circuit, one damper circuit in each axis, exponential saturation.
//
// Conventions are those of GENROU. Integrated with PSS/E's own time steps, the equations reproduce PSS/E's
// record psse_powersimulationsdynamics/GENSAE within 0.0001 degrees over 10 s. The error is 0.0016 degrees
// with speed voltage and 0.016 degrees with mechanical torque in place of power. The record has D = 0; no
// available record verifies the damping.
#include "sim/effects/detail/salient_pole.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::machine_gensae {

struct Model : shared::SalientPole {
  static constexpr std::string_view name = "GENSAE", title = "salient-pole machine, exponential saturation",
                                    source = "PSS/E GENSAE; IEEE Std 1110-2019 model 2.1; Kundur (1994), 5.1",
                                    dyr_name = "GENSAE";
  static constexpr std::string_view description = R"(
   psi''d = gd1 E'q + (1 - gd1) psi1d          gd1 = (X'' - Xl)/(X'd - Xl)
   E'' = (-psi''q + j psi''d)(1 + w) exp(j(delta - pi/2)) behind Ra + jX''    (1 + w): speed voltage, not in PSS/E
   Se = S1.0 |psi''|^x, x = ln(S1.2/S1.0)/ln 1.2: Se(1.2) = S1.2;  S1.0 = 0: no saturation
   Xad Ifd = E'q + (Xd - X'd)(Id - kd td) + psi''d Se      td = psi1d + (X'd - Xl) Id - E'q
   T'do dE'q/dt   = Efd - Xad Ifd                          kd = (X'd - X'')/(X'd - Xl)^2
   T''do dpsi1d/dt = -td                                   ks = (Xq - Xl)/(Xd - Xl)
   T''qo dpsi''q/dt = -psi''q (1 + ks Se) - (Xq - X'') Iq
   2H dw/dt = Tm - Te - D w   (PSS/E's convention: (Pm - D w)/(1 + w) - Te)      Te = psi''d Iq - psi''q Id
)";
  static constexpr auto parameters =
      parameters_with("saturation factor at 1.0 pu flux (0: none)", "saturation factor at 1.2 pu flux");
  enum { ks = circuits, s10, exponent, coefficients };
  enum { Se = rotor, scratch };

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    check_circuits(values, p);
    values.require_difference(Xd, Xl);
    check_saturation<ExponentialSaturation>(values, p);
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    prepare_circuits(p, conventions, c);
    c[ks] = (p[Xq] - p[Xl]) / (p[Xd] - p[Xl]);
    c[s10] = p[S10];
    c[exponent] = saturation_exponent(p[S10], p[S12]);
  }
  /// Returns the saturation factor Se of the subtransient flux; it raises the field current by psi''d Se.
  template <class T>
  static T saturated(const T* c, const T& d, const T& q) {
    return exponential_saturation(c[s10], c[exponent], d * d + q * q);
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    stator(c, x, m, s);
    m[Se] = saturated(c, m[pd], x[psi2q]);
    s.Ifd = unsaturated_field(c, x, m) + m[pd] * m[Se];
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    rotor_derivative(c, x, m, s, x[psi2q] * (T(1.0) + c[ks] * m[Se]), dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::atan2;
    // The voltage behind X'' has the magnitude of psi'', which determines Se before the angle is known.
    const T er = s.Vr + p[Ra] * s.Ir - p[Xdpp] * s.Ii, ei = s.Vi + p[Ra] * s.Ii + p[Xdpp] * s.Ir;
    const T se = saturated(c, er, ei);
    const T k = c[dXq] / (T(1.0) + c[ks] * se);  // the q axis lies along E'' + jk I
    x[delta] = atan2(ei + k * s.Ir, er - k * s.Ii);
    x[speed] = T(0.0);
    T sd, cd;
    sincos(x[delta], sd, cd);
    const T id = s.Ir * sd - s.Ii * cd, iq = s.Ir * cd + s.Ii * sd;
    const T flux_d = er * cd + ei * sd;
    x[psi2q] = ei * cd - er * sd;
    x[Eqp] = flux_d + (p[Xdp] - p[Xdpp]) * id;
    x[psi1d] = x[Eqp] - c[xdl] * id;
    s.Efd = x[Eqp] + c[dXd] * id + flux_d * se;
    s.Tm = flux_d * iq - x[psi2q] * id;
    return {};
  }
};

}  // namespace swingbank::sim::effects::machine_gensae
