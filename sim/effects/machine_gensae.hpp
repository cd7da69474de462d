#pragma once
// GENSAE: salient-pole machine, one field and one damper circuit in each axis, exponential saturation.
//
// Conventions. As GENROU. With PSS/E's own steps its record psse_powersimulationsdynamics/GENSAE agrees to
// 0.0001 degrees over 10 s, with speed voltage to 0.0016, with torque to 0.016. It has D = 0: no record at
// hand shows the damping.
#include <fmt/format.h>

#include "sim/core/effect.hpp"
#include "sim/core/saturation.hpp"

namespace swingbank::sim::machine_gensae {

struct Model {
  static constexpr std::string_view name = "GENSAE", title = "salient-pole machine, exponential saturation",
                                    source = "PSS/E GENSAE; IEEE Std 1110-2019 model 2.1; Kundur (1994), 5.1",
                                    dyr_name = "GENSAE";
  static constexpr Slot slot = Slot::machine;
  static constexpr std::string_view description = R"(
   psi''d = gd1 E'q + (1 - gd1) psi1d          gd1 = (X'' - Xl)/(X'd - Xl)
   E'' = (-psi''q + j psi''d)(1 + w) exp(j(delta - pi/2)) behind Ra + jX''    (speed voltage: convention)
   Se = S1.0 |psi''|^x, x = ln(S1.2/S1.0)/ln 1.2: Se(1.2) = S1.2;  S1.0 = 0: no saturation
   Xad Ifd = E'q + (Xd - X'd)(Id - kd td) + psi''d Se      td = psi1d + (X'd - Xl) Id - E'q
   T'do dE'q/dt   = Efd - Xad Ifd                          kd = (X'd - X'')/(X'd - Xl)^2
   T''do dpsi1d/dt = -td                                   ks = (Xq - Xl)/(Xd - Xl)
   T''qo dpsi''q/dt = -psi''q (1 + ks Se) - (Xq - X'') Iq
   2H dw/dt = Tm - Te - D w   (convention: (Pm - D w)/(1 + w) - Te)      Te = psi''d Iq - psi''q Id
)";
  enum P { Tdop, Tdopp, Tqopp, H, D, Xd, Xq, Xdp, Xdpp, Xl, S10, S12, Ra };
  static constexpr Parameter parameters[] = {
      {"Tdop", "T'do", "s", 6.0, 0.5, 20.0, kNoNeutral, "d-axis transient open-circuit time constant"},
      {"Tdopp", "T''do", "s", 0.05, 0.005, 999.0, kNoNeutral,
       "d-axis subtransient open-circuit time constant"},
      {"Tqopp", "T''qo", "s", 0.08, 0.005, 999.0, kNoNeutral,
       "q-axis subtransient open-circuit time constant"},
      {"H", "H", "s", 4.0, 0.1, 20.0, kNoNeutral, "inertia constant"},
      {"D", "D", "pu", 0.0, 0.0, 20.0, 0.0, "damping torque per unit speed deviation"},
      {"Xd", "Xd", "pu", 1.2, 0.1, 4.0, kNoNeutral, "d-axis synchronous reactance"},
      {"Xq", "Xq", "pu", 0.75, 0.1, 4.0, kNoNeutral, "q-axis synchronous reactance"},
      {"Xdp", "X'd", "pu", 0.35, 0.02, 2.5, kNoNeutral, "d-axis transient reactance"},
      {"Xdpp", "X''d", "pu", 0.25, 0.01, 1.0, kNoNeutral, "subtransient reactance, both axes"},
      {"Xl", "Xl", "pu", 0.15, 0.0, 0.9, kNoNeutral, "stator leakage reactance"},
      {"S10", "S1.0", "-", 0.1, 0.0, 2.0, 0.0, "saturation factor at 1.0 pu flux (0: none)"},
      {"S12", "S1.2", "-", 0.4, 0.0, 10.0, 0.0, "saturation factor at 1.2 pu flux"},
      {"Ra", "Ra", "pu", 0.0, 0.0, 0.1, 0.0, "armature resistance"}};
  /// Where saturation is steep a flux error counts tenfold in the field current, as in GENROU.
  static constexpr double kFluxWeight = 10.0;
  enum X { delta, speed, Eqp, psi1d, psi2q };
  static constexpr State states[] = {{"delta", "rad", "rotor angle in the synchronous frame"},
                                     {"speed", "pu", "speed deviation", 100.0},
                                     {"Eqp", "pu", "q-axis transient voltage", kFluxWeight},
                                     {"psi1d", "pu", "d-axis damper flux", kFluxWeight},
                                     {"psi2q", "pu", "q-axis subtransient flux", kFluxWeight}};
  static constexpr int dyr_columns[] = {Tdop, Tdopp, Tqopp, H, D, Xd, Xq, Xdp, Xdpp, Xl, S10, S12};
  static constexpr int raw_resistance = Ra, raw_reactance = -1;
  enum C {
    gd1,
    gd2,
    xdl,
    dXd,
    dXq,
    kd,
    ks,
    s10,
    exponent,
    iTdop,
    iTdopp,
    iTqopp,
    i2H,
    kD,
    W0,
    speed_voltage,
    power,
    coefficients
  };
  enum M { sn, cs, pd, Id, Iq, Se, td, scratch };

  static void check(const double* p, const std::string& where, Problems& problems);
  static std::string_view unphysical(const double* p) {
    if (!(p[Xd] > p[Xdp] && p[Xdp] > p[Xdpp] && p[Xdpp] > p[Xl])) return "Xd > X'd > X''d > Xl";
    if (!(p[Xq] > p[Xdpp])) return "Xq > X''q";
    if (!(p[Tdop] > p[Tdopp])) return "T'do > T''do";
    if (p[S10] > 0 && !(p[S12] > p[S10])) return "S1.2 > S1.0";
    return "";
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    c[xdl] = p[Xdp] - p[Xl];
    c[gd1] = (p[Xdpp] - p[Xl]) / c[xdl];
    c[gd2] = T(1.0) - c[gd1];
    c[dXd] = p[Xd] - p[Xdp];
    c[dXq] = p[Xq] - p[Xdpp];
    c[kd] = (p[Xdp] - p[Xdpp]) / (c[xdl] * c[xdl]);
    c[ks] = (p[Xq] - p[Xl]) / (p[Xd] - p[Xl]);
    c[s10] = p[S10];
    c[exponent] = saturation_exponent(p[S10], p[S12]);
    c[iTdop] = T(1.0) / p[Tdop];
    c[iTdopp] = T(1.0) / p[Tdopp];
    c[iTqopp] = T(1.0) / p[Tqopp];
    c[i2H] = T(0.5) / p[H];
    c[kD] = p[D];
    c[W0] = T(2.0 * 3.14159265358979323846 * conventions.frequency);
    c[speed_voltage] = T(conventions.speed_voltage ? 1.0 : 0.0);
    c[power] = T(conventions.mechanical_power ? 1.0 : 0.0);
  }
  template <class T>
  static void source_impedance(const T* p, T& r, T& x) {
    r = p[Ra];
    x = p[Xdpp];
  }
  /// Saturation factor of the subtransient flux: the field needs psi''d Se more current.
  template <class T>
  static T saturated(const T* c, const T& d, const T& q) {
    return exponential_saturation(c[s10], c[exponent], d * d + q * q);
  }
  template <class T>
  static void emf(const T* c, const T* x, T* m, T& er, T& ei) {
    sincos(x[delta], m[sn], m[cs]);
    m[pd] = c[gd1] * x[Eqp] + c[gd2] * x[psi1d];
    const T w = T(1.0) + c[speed_voltage] * x[speed];
    const T eq = m[pd] * w, ed = T(0.0) - x[psi2q] * w;
    er = ed * m[sn] + eq * m[cs];
    ei = eq * m[sn] - ed * m[cs];
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    m[Id] = s.Ir * m[sn] - s.Ii * m[cs];
    m[Iq] = s.Ir * m[cs] + s.Ii * m[sn];
    m[Se] = saturated(c, m[pd], x[psi2q]);
    m[td] = x[psi1d] + c[xdl] * m[Id] - x[Eqp];
    s.speed = x[speed];
    s.Te = m[pd] * m[Iq] - x[psi2q] * m[Id];
    s.Ifd = x[Eqp] + c[dXd] * (m[Id] - c[kd] * m[td]) + m[pd] * m[Se];
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    const T driving = (s.Tm - c[kD] * x[speed]) / (T(1.0) + c[power] * x[speed]);
    dx[delta] = c[W0] * x[speed];
    dx[speed] = (driving - s.Te) * c[i2H];
    dx[Eqp] = (s.Efd - s.Ifd) * c[iTdop];
    dx[psi1d] = T(0.0) - m[td] * c[iTdopp];
    dx[psi2q] = (T(0.0) - x[psi2q] * (T(1.0) + c[ks] * m[Se]) - c[dXq] * m[Iq]) * c[iTqopp];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::atan2;
    // The voltage behind X'' has the magnitude of psi'', so Se is known before the angle is.
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

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  for (const int i : {H, Tdop, Tdopp, Tqopp, Xdpp})
    if (!(p[i] > 0))
      problems.add(fmt::format("{} = {:g} {}", parameters[i].symbol, p[i], parameters[i].unit), where,
                   "GENSAE divides by it", "give a value > 0 (PSS/E: 999 s for a damper that is not there)");
  if (!(p[Xdp] > p[Xl]))
    problems.add(fmt::format("X'd = {:g} pu with Xl = {:g} pu", p[Xdp], p[Xl]), where,
                 "GENSAE divides by X'd - Xl", "give X'd > Xl");
  if (!(p[Xd] > p[Xl]))
    problems.add(fmt::format("Xd = {:g} pu with Xl = {:g} pu", p[Xd], p[Xl]), where,
                 "GENSAE divides by Xd - Xl", "give Xd > Xl");
  if (p[S10] > 0 && !(p[S12] > 0))
    problems.add(fmt::format("S1.0 = {:g} with S1.2 = {:g}", p[S10], p[S12]), where,
                 "no power of the flux passes through both", "give S1.2 > 0, or S1.0 = 0 for no saturation");
}

}  // namespace swingbank::sim::machine_gensae
