#pragma once
// Salient-pole machine of GENSAL and GENSAE: one field circuit, and one damper circuit in each axis. A Model
// defines the saturation: it adds its coefficients from `circuits` on and implements prepare, electrical,
// derivative and steady with the functions below.

#include "base/constants.hpp"
#include "sim/core/effect.hpp"
#include "sim/core/saturation.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

struct SalientPole {
  static constexpr Slot slot = Slot::machine;
  enum P { Tdop, Tdopp, Tqopp, H, D, Xd, Xq, Xdp, Xdpp, Xl, S10, S12, Ra, parameter_count };
  static constexpr Source kAsRound = literature::own("as for the round rotor");
  static constexpr Source kNoDamper = literature::psid("EXAC1/TVC_System.dyr, where 999 means no damper");
  static constexpr Source defaults_from = literature::kundur("within table 4.2, hydraulic units");
  static constexpr Source bounds_from = kBeyondKundur;
  /// Returns all parameters; `s10`, `s12`: meaning of the saturation factors.
  static constexpr std::array<Parameter, parameter_count> parameters_with(std::string_view s10,
                                                                          std::string_view s12) {
    return {
        {{"Tdop", "T'do", "s", 6.0, 0.5, 20.0, kNoNullValue, "d-axis transient open-circuit time constant"},
         {"Tdopp", "T''do", "s", 0.05, 0.005, 999.0, kNoNullValue,
          "d-axis subtransient open-circuit time constant", kAsEffect, kNoDamper},
         {"Tqopp", "T''qo", "s", 0.08, 0.005, 999.0, kNoNullValue,
          "q-axis subtransient open-circuit time constant", kAsEffect, kNoDamper},
         {"H", "H", "s", 4.0, 0.1, 20.0, kNoNullValue, "inertia constant",
          literature::kundur("within table 3.2, hydraulic units")},
         {"D", "D", "pu", 0.0, 0.0, 20.0, 0.0, "damping torque per unit speed deviation",
          literature::cim("RotatingMachineDynamics"), kDamping},
         {"Xd", "Xd", "pu", 1.2, 0.1, 4.0, kNoNullValue, "d-axis synchronous reactance"},
         {"Xq", "Xq", "pu", 0.75, 0.1, 4.0, kNoNullValue, "q-axis synchronous reactance"},
         {"Xdp", "X'd", "pu", 0.35, 0.02, 2.5, kNoNullValue, "d-axis transient reactance"},
         {"Xdpp", "X''d", "pu", 0.25, 0.01, 1.0, kNoNullValue, "subtransient reactance, both axes"},
         {"Xl", "Xl", "pu", 0.15, 0.0, 0.9, kNoNullValue, "stator leakage reactance"},
         {"S10", "S1.0", "-", 0.1, 0.0, 2.0, 0.0, s10, kAsRound, kSaturation},
         {"S12", "S1.2", "-", 0.4, 0.0, 10.0, 0.0, s12, kAsRound, kSaturation},
         {"Ra", "Ra", "pu", 0.0, 0.0, 0.1, 0.0, "armature resistance", kNeglected}}};
  }
  /// Weight of flux errors in step size control, as for the round-rotor machine: above a steep saturation
  /// knee the gain from a flux error to the field current is about 10.
  static constexpr double kFluxWeight = 10.0;
  enum X { delta, speed, Eqp, psi1d, psi2q };
  static constexpr State states[] = {{"delta", "rad", "rotor angle in the synchronous frame"},
                                     {"speed", "pu", "speed deviation", 100.0},
                                     {"Eqp", "pu", "q-axis transient voltage", kFluxWeight},
                                     {"psi1d", "pu", "d-axis damper flux", kFluxWeight},
                                     {"psi2q", "pu", "q-axis subtransient flux", kFluxWeight}};
  static constexpr int dyr_columns[] = {Tdop, Tdopp, Tqopp, H, D, Xd, Xq, Xdp, Xdpp, Xl, S10, S12};
  static constexpr int raw_resistance = Ra, raw_reactance = -1;
  enum C { gd1, gd2, xdl, dXd, dXq, kd, iTdop, iTdopp, iTqopp, i2H, kD, W0, speed_voltage, power, circuits };
  enum M { sn, cs, pd, Id, Iq, td, rotor };  ///< a Model's own scratch begins at `rotor`

  static void check_circuits(const ValueCheck& values, const double* p) {
    for (const int i : {H, Tdop, Tdopp, Tqopp, Xdpp})
      values.refuse(!(p[i] > 0), i, values.divides(), "give a value > 0 (PSS/E: 999 s for no damper)");
    values.require_difference(Xdp, Xl);
  }
  template <class Saturation>
  static void check_saturation(const ValueCheck& values, const double* p) {
    values.refuse(!Saturation::possible(p[S10], p[S12]), values.text(S10, S12), Saturation::impossible,
                  Saturation::remedy);
  }
  static std::string_view unphysical(const double* p) {
    if (!(p[Xd] > p[Xdp] && p[Xdp] > p[Xdpp] && p[Xdpp] > p[Xl])) return "Xd > X'd > X''d > Xl";
    if (!(p[Xq] > p[Xdpp])) return "Xq > X''q";
    if (!(p[Tdop] > p[Tdopp])) return "T'do > T''do";
    if (p[S10] > 0 && !(p[S12] > p[S10])) return "S1.2 > S1.0";
    return "";
  }

  template <class T>
  static void prepare_circuits(const T* p, const Conventions& conventions, T* c) {
    c[xdl] = p[Xdp] - p[Xl];
    c[gd1] = (p[Xdpp] - p[Xl]) / c[xdl];
    c[gd2] = T(1.0) - c[gd1];
    c[dXd] = p[Xd] - p[Xdp];
    c[dXq] = p[Xq] - p[Xdpp];
    c[kd] = (p[Xdp] - p[Xdpp]) / (c[xdl] * c[xdl]);
    c[iTdop] = T(1.0) / p[Tdop];
    c[iTdopp] = T(1.0) / p[Tdopp];
    c[iTqopp] = T(1.0) / p[Tqopp];
    c[i2H] = T(0.5) / p[H];
    c[kD] = p[D];
    c[W0] = T(constants::turn * conventions.frequency);
    c[speed_voltage] = T(conventions.speed_voltage ? 1.0 : 0.0);
    c[power] = T(conventions.mechanical_power ? 1.0 : 0.0);
  }
  template <class T>
  static void source_impedance(const T* p, T& r, T& x) {
    r = p[Ra];
    x = p[Xdpp];
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
  /// Computes all stator quantities except the field current.
  template <class T>
  static void stator(const T* c, const T* x, T* m, Signals<T>& s) {
    m[Id] = s.Ir * m[sn] - s.Ii * m[cs];
    m[Iq] = s.Ir * m[cs] + s.Ii * m[sn];
    m[td] = x[psi1d] + c[xdl] * m[Id] - x[Eqp];
    s.speed = x[speed];
    s.Te = m[pd] * m[Iq] - x[psi2q] * m[Id];
  }
  /// Returns the field current without saturation [pu].
  template <class T>
  static T unsaturated_field(const T* c, const T* x, const T* m) {
    return x[Eqp] + c[dXd] * (m[Id] - c[kd] * m[td]);
  }
  /// Computes the rotor's derivatives. `excited`: psi''q with the saturation of the q axis, psi''q (1 + ks
  /// Se) for GENSAE and psi''q for GENSAL [pu].
  template <class T>
  static void rotor_derivative(const T* c, const T* x, const T* m, const Signals<T>& s, const T& excited,
                               T* dx) {
    const T driving = (s.Tm - c[kD] * x[speed]) / (T(1.0) + c[power] * x[speed]);
    dx[delta] = c[W0] * x[speed];
    dx[speed] = (driving - s.Te) * c[i2H];
    dx[Eqp] = (s.Efd - s.Ifd) * c[iTdop];
    dx[psi1d] = T(0.0) - m[td] * c[iTdopp];
    dx[psi2q] = (T(0.0) - excited - c[dXq] * m[Iq]) * c[iTqopp];
  }
};

}  // namespace swingbank::sim::effects::shared
