#pragma once
// Round-rotor machine of GENROU and GENROE: one field and three damper circuits. The two effects differ in
// the saturation of the subtransient flux, QuadraticSaturation or ExponentialSaturation.
#include "base/constants.hpp"
#include "sim/core/effect.hpp"
#include "sim/core/saturation.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

template <class Model, class Saturation>
struct RoundRotor {
  static constexpr Slot slot = Slot::machine;
  enum P { Tdop, Tdopp, Tqop, Tqopp, H, D, Xd, Xq, Xdp, Xqp, Xdpp, Xl, S10, S12, Ra };
  static constexpr Source defaults_from = literature::kundur("within table 4.2, thermal units");
  static constexpr Source bounds_from = kBeyondKundur;
  static constexpr Parameter parameters[] = {
      {"Tdop", "T'do", "s", 7.0, 0.5, 20.0, kNoNullValue, "d-axis transient open-circuit time constant"},
      {"Tdopp", "T''do", "s", 0.04, 0.005, 0.5, kNoNullValue,
       "d-axis subtransient open-circuit time constant"},
      {"Tqop", "T'qo", "s", 0.8, 0.05, 5.0, kNoNullValue, "q-axis transient open-circuit time constant"},
      {"Tqopp", "T''qo", "s", 0.06, 0.005, 0.5, kNoNullValue,
       "q-axis subtransient open-circuit time constant", kSlowDamper},
      {"H", "H", "s", 5.0, 0.1, 20.0, kNoNullValue, "inertia constant", kThermalInertia},
      {"D", "D", "pu", 0.0, 0.0, 20.0, 0.0, "damping torque per unit speed deviation",
       literature::cim("RotatingMachineDynamics"), kDamping},
      {"Xd", "Xd", "pu", 1.8, 0.1, 4.0, kNoNullValue, "d-axis synchronous reactance", kTwoAreas},
      {"Xq", "Xq", "pu", 1.7, 0.1, 4.0, kNoNullValue, "q-axis synchronous reactance", kTwoAreas},
      {"Xdp", "X'd", "pu", 0.3, 0.02, 2.5, kNoNullValue, "d-axis transient reactance", kTwoAreas},
      {"Xqp", "X'q", "pu", 0.55, 0.02, 2.5, kNoNullValue, "q-axis transient reactance", kTwoAreas},
      {"Xdpp", "X''d", "pu", 0.25, 0.01, 1.0, kNoNullValue, "subtransient reactance, both axes", kTwoAreas},
      {"Xl", "Xl", "pu", 0.15, 0.0, 0.9, kNoNullValue, "stator leakage reactance"},
      {"S10", "S1.0", "-", 0.1, 0.0, 2.0, 0.0, "saturation factor at 1.0 pu flux (0: none)", kMildSaturation,
       kSaturation},
      {"S12", "S1.2", "-", 0.4, 0.0, 10.0, 0.0, "saturation factor at 1.2 pu flux", kMildSaturation,
       kSaturation},
      {"Ra", "Ra", "pu", 0.0, 0.0, 0.1, 0.0, "armature resistance", kNeglected}};
  /// Weight of flux errors in step size control. Above a steep saturation knee (B up to 70) the gain from a
  /// flux error to the field current is about 10, and the resulting angle error persists.
  static constexpr double kFluxWeight = 10.0;
  enum X { delta, speed, Eqp, Edp, psi1d, psi2q };
  static constexpr State states[] = {{"delta", "rad", "rotor angle in the synchronous frame"},
                                     {"speed", "pu", "speed deviation", 100.0},
                                     {"Eqp", "pu", "q-axis transient voltage", kFluxWeight},
                                     {"Edp", "pu", "d-axis transient voltage", kFluxWeight},
                                     {"psi1d", "pu", "d-axis damper flux", kFluxWeight},
                                     {"psi2q", "pu", "second q-axis damper flux", kFluxWeight}};
  static constexpr int dyr_columns[] = {Tdop, Tdopp, Tqop, Tqopp, H, D, Xd, Xq, Xdp, Xqp, Xdpp, Xl, S10, S12};
  static constexpr int raw_resistance = Ra, raw_reactance = -1;

  /// Time constant of E'd if T'qo = 0, which means that there is no such rotor circuit [s].
  static constexpr double kAtOnce = 0.01;

  enum C {
    gd1,
    gd2,
    gq1,
    gq2,
    xdl,
    xql,
    dXd,
    dXq,
    kd,
    kq,
    ks,
    sat_a,
    sat_b,
    iTdop,
    iTdopp,
    iTqop,
    iTqopp,
    i2H,
    kD,
    W0,
    speed_voltage,
    power,
    coefficients
  };
  enum M { sn, cs, pd, pq, Id, Iq, Se, td, scratch };

  static void check(const double* p, const std::string& where, Problems& problems);
  static std::string remark(const double* p) {
    std::string text;
    if (p[Tqop] == 0.0)
      text = "T'qo = 0: no transient circuit in the q axis; E'd has a time constant of 10 ms";
    if (p[Xqp] < p[Xl]) text += (text.empty() ? "" : "; ") + std::string("X'q below Xl is not physical");
    return text;
  }
  static std::string_view unphysical(const double* p) {
    if (!(p[Xd] > p[Xdp] && p[Xdp] > p[Xdpp] && p[Xdpp] > p[Xl])) return "Xd > X'd > X''d > Xl";
    if (!(p[Xq] > p[Xqp] && p[Xqp] > p[Xdpp])) return "Xq > X'q > X''q";
    if (!(p[Tdop] > p[Tdopp] && p[Tqop] > p[Tqopp])) return "T'o > T''o";
    if (p[S10] > 0 && !(p[S12] > p[S10])) return "S1.2 > S1.0";
    return "";
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    const T xd = p[Xdp] - p[Xl], xq = p[Xqp] - p[Xl], xs = p[Xdpp] - p[Xl];
    c[gd1] = xs / xd;
    c[gd2] = T(1.0) - c[gd1];
    c[gq1] = xs / xq;
    c[gq2] = T(1.0) - c[gq1];
    c[xdl] = xd;
    c[xql] = xq;
    c[dXd] = p[Xd] - p[Xdp];
    c[dXq] = p[Xq] - p[Xqp];
    c[kd] = (p[Xdp] - p[Xdpp]) / (xd * xd);
    c[kq] = (p[Xqp] - p[Xdpp]) / (xq * xq);
    c[ks] = (p[Xq] - p[Xl]) / (p[Xd] - p[Xl]);
    Saturation::prepare(p[S10], p[S12], c[sat_a], c[sat_b]);
    c[iTdop] = T(1.0) / p[Tdop];
    c[iTdopp] = T(1.0) / p[Tdopp];
    c[iTqop] = T(1.0) / select(p[Tqop] > T(0.0), p[Tqop], T(kAtOnce));
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
  /// Returns the saturation factor Se of the subtransient flux; it raises the field current by psi''d Se.
  template <class T>
  static T saturated(const T* c, const T& d, const T& q) {
    return Saturation::factor(c[sat_a], c[sat_b], d * d + q * q);
  }
  template <class T>
  static void emf(const T* c, const T* x, T* m, T& er, T& ei) {
    sincos(x[delta], m[sn], m[cs]);
    m[pd] = c[gd1] * x[Eqp] + c[gd2] * x[psi1d];
    m[pq] = c[gq2] * x[psi2q] - c[gq1] * x[Edp];
    const T w = T(1.0) + c[speed_voltage] * x[speed];
    const T eq = m[pd] * w, ed = T(0.0) - m[pq] * w;
    er = ed * m[sn] + eq * m[cs];
    ei = eq * m[sn] - ed * m[cs];
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    m[Id] = s.Ir * m[sn] - s.Ii * m[cs];
    m[Iq] = s.Ir * m[cs] + s.Ii * m[sn];
    m[Se] = saturated(c, m[pd], m[pq]);
    m[td] = x[psi1d] + c[xdl] * m[Id] - x[Eqp];
    s.speed = x[speed];
    s.Te = m[pd] * m[Iq] - m[pq] * m[Id];
    s.Ifd = x[Eqp] + c[dXd] * (m[Id] - c[kd] * m[td]) + m[pd] * m[Se];
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    const T tq = x[psi2q] + c[xql] * m[Iq] + x[Edp];
    const T driving = (s.Tm - c[kD] * x[speed]) / (T(1.0) + c[power] * x[speed]);
    dx[delta] = c[W0] * x[speed];
    dx[speed] = (driving - s.Te) * c[i2H];
    dx[Eqp] = (s.Efd - s.Ifd) * c[iTdop];
    dx[Edp] = (c[dXq] * (m[Iq] - c[kq] * tq) - x[Edp] + c[ks] * m[pq] * m[Se]) * c[iTqop];
    dx[psi1d] = T(0.0) - m[td] * c[iTdopp];
    dx[psi2q] = T(0.0) - tq * c[iTqopp];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::atan2;
    // The voltage behind X'' has the magnitude of psi'', which determines Se before the angle is known.
    const T er = s.Vr + p[Ra] * s.Ir - p[Xdpp] * s.Ii, ei = s.Vi + p[Ra] * s.Ii + p[Xdpp] * s.Ir;
    const T se = saturated(c, er, ei);
    const T k = (p[Xq] - p[Xdpp]) / (T(1.0) + c[ks] * se);  // the q axis lies along E'' + jk I
    x[delta] = atan2(ei + k * s.Ir, er - k * s.Ii);
    x[speed] = T(0.0);
    T sd, cd;
    sincos(x[delta], sd, cd);
    const T flux_d = er * cd + ei * sd, flux_q = ei * cd - er * sd;
    const T id = s.Ir * sd - s.Ii * cd, iq = s.Ir * cd + s.Ii * sd;
    x[Eqp] = flux_d + (p[Xdp] - p[Xdpp]) * id;
    x[psi1d] = x[Eqp] - c[xdl] * id;
    x[Edp] = c[dXq] * iq + c[ks] * flux_q * se;
    x[psi2q] = T(0.0) - x[Edp] - c[xql] * iq;
    s.Efd = x[Eqp] + c[dXd] * id + flux_d * se;
    s.Tm = flux_d * iq - flux_q * id;
    return {};
  }
};

template <class Model, class Saturation>
void RoundRotor<Model, Saturation>::check(const double* p, const std::string& where, Problems& problems) {
  const ValueCheck values(Model::name, parameters, p, where, problems);
  values.refuse(!(p[H] > 0), H, "the swing equation divides by H",
                "give H > 0 (an infinite bus is GENCLS with H = 0)");
  values.refuse(!(p[Tqop] >= 0), Tqop, "a time constant cannot be negative",
                "give a value > 0, or 0 for no such circuit");
  values.require_divisors({Tdop, Tdopp, Tqopp});
  values.require_difference(Xdp, Xl);
  values.refuse(!(p[Xqp] != p[Xl]), values.text(Xqp, Xl), fmt::format("{} divides by X'q - Xl", Model::name),
                "give X'q > Xl");  // below Xl it is accepted with a remark, as in PSS/E
  values.require_difference(Xd, Xl);
  values.require_positive({Xdpp}, "the machine needs a reactance behind its terminal");
  values.refuse(!Saturation::possible(p[S10], p[S12]), values.text(S10, S12), Saturation::impossible,
                Saturation::remedy);
}

}  // namespace swingbank::sim::effects::shared
