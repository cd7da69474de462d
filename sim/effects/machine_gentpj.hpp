#pragma once
// GENTPJ: synchronous machine with two rotor circuits in each axis. All inductances except the leakage
// saturate with the air-gap flux and the stator current.
//
// The factor Se depends on the air-gap flux, and the flux on the stator current. The current depends on the
// subtransient reactances, which Se reduces. The function current() solves this loop for Se by Newton's
// method.
//
// Conventions are assumed to be those of GENROU; no available record verifies them.

#include "base/constants.hpp"
#include "sim/core/effect.hpp"
#include "sim/core/saturation.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::machine_gentpj {

struct Model {
  static constexpr std::string_view
      name = "GENTPJ",
      title = "synchronous machine, saturation of every inductance by flux and stator current",
      source =
          "J. Undrill, The GENTPJ model (2007); J. Weber, Description of machine models GENROU, GENSAL, "
          "GENTPF and GENTPJ (PowerWorld, 2015); PSS/E GENTPJU1",
      dyr_name = "GENTPJU1";
  static constexpr Slot slot = Slot::machine;
  static constexpr std::string_view description = R"(
   Se = B (u - A)^2/u above A, with Se(1.0) = S1.0 and Se(1.2) = S1.2;  S1.0 = 0: none
   u = |V + (Ra + jXl) I| + Kis |I|                        (air-gap flux and stator current; Kis = 0: GENTPF)
   kd = 1 + Se    kq = 1 + Se Xq/Xd                        X''ds = Xl + (X''d - Xl)/kd, X''qs likewise by kq
   Vd = -psi''q (1 + w) + X''qs Iq - Ra Id                 (1 + w): speed voltage, not in PSS/E
   Vq =  psi''d (1 + w) - X''ds Id - Ra Iq
   Xad Ifd = kd (E'q (Xd - X''d) - psi''d (Xd - X'd))/(X'd - X''d)      T'do dE'q/dt = Efd - Xad Ifd
   T'qo dE'd/dt = -kq (E'd (Xq - X''q) + psi''q (Xq - X'q))/(X'q - X''q);  T'qo = 0 (X'q = Xq): E'd = 0
   T''do dpsi''d/dt = -kd (psi''d - E'q) - (X'd - X''d) Id
   T''qo dpsi''q/dt = -kq (psi''q + E'd) - (X'q - X''q) Iq
   2H dw/dt = Tm - Te - D w   (PSS/E's convention: (Pm - D w)/(1 + w) - Te)
   Te = (psi''d - X''ds Id) Iq - (psi''q - X''qs Iq) Id
   Without saturation this is GENROU with Xl = X'' in its rotor circuits.
)";
  enum P { Tdop, Tdopp, Tqop, Tqopp, H, D, Xd, Xq, Xdp, Xqp, Xdpp, Xqpp, Xl, S10, S12, Kis, Ra };
  static constexpr Source defaults_from = literature::kundur("within table 4.2, thermal units");
  static constexpr Source bounds_from = shared::kBeyondKundur;
  static constexpr Parameter parameters[] = {
      {"Tdop", "T'do", "s", 7.0, 0.5, 20.0, kNoNullValue, "d-axis transient open-circuit time constant"},
      {"Tdopp", "T''do", "s", 0.04, 0.005, 0.5, kNoNullValue,
       "d-axis subtransient open-circuit time constant"},
      {"Tqop", "T'qo", "s", 0.8, 0.0, 5.0, kNoNullValue,
       "q-axis transient open-circuit time constant (0, with X'q = Xq: no such circuit)", kAsEffect,
       literature::own("0: no such circuit; upper bound more than twice Kundur's 2 s (table 4.2)")},
      {"Tqopp", "T''qo", "s", 0.06, 0.005, 0.5, kNoNullValue,
       "q-axis subtransient open-circuit time constant", shared::kSlowDamper},
      {"H", "H", "s", 5.0, 0.1, 20.0, kNoNullValue, "inertia constant", shared::kThermalInertia},
      {"D", "D", "pu", 0.0, 0.0, 20.0, 0.0, "damping torque per unit speed deviation",
       literature::cim("RotatingMachineDynamics"), shared::kDamping},
      {"Xd", "Xd", "pu", 1.8, 0.1, 4.0, kNoNullValue, "d-axis synchronous reactance", shared::kTwoAreas},
      {"Xq", "Xq", "pu", 1.7, 0.1, 4.0, kNoNullValue, "q-axis synchronous reactance", shared::kTwoAreas},
      {"Xdp", "X'd", "pu", 0.3, 0.02, 2.5, kNoNullValue, "d-axis transient reactance", shared::kTwoAreas},
      {"Xqp", "X'q", "pu", 0.55, 0.02, 4.0, kNoNullValue, "q-axis transient reactance", shared::kTwoAreas,
       literature::derived("as far as Xq, where there is no such circuit")},
      {"Xdpp", "X''d", "pu", 0.25, 0.01, 1.0, kNoNullValue, "d-axis subtransient reactance",
       shared::kTwoAreas},
      {"Xqpp", "X''q", "pu", 0.27, 0.01, 1.0, kNoNullValue, "q-axis subtransient reactance",
       literature::own("other than X''d, so that the saliency acts")},
      {"Xl", "Xl", "pu", 0.15, 0.0, 0.9, kNoNullValue, "stator leakage reactance"},
      {"S10", "S1.0", "-", 0.1, 0.0, 2.0, 0.0, "saturation factor at 1.0 pu flux (0: none)",
       shared::kMildSaturation, shared::kSaturation},
      {"S12", "S1.2", "-", 0.4, 0.0, 10.0, 0.0, "saturation factor at 1.2 pu flux", shared::kMildSaturation,
       shared::kSaturation},
      {"Kis", "Kis", "pu/pu", 0.05, 0.0, 0.5, 0.0, "equivalent flux of the stator current in the saturation",
       literature::own("not 0, so that the current acts on the saturation; CIM has 0"),
       literature::own("half of the current as flux")},
      {"Ra", "Ra", "pu", 0.0, 0.0, 0.1, 0.0, "armature resistance", shared::kNeglected}};
  /// Weight of flux errors in step size control: with steep saturation the gain from a flux error to the
  /// field current is about 10, as in GENROU.
  static constexpr double kFluxWeight = 10.0;
  enum X { delta, speed, Eqp, Edp, psid, psiq };
  static constexpr State states[] = {{"delta", "rad", "rotor angle in the synchronous frame"},
                                     {"speed", "pu", "speed deviation", 100.0},
                                     {"Eqp", "pu", "q-axis transient voltage", kFluxWeight},
                                     {"Edp", "pu", "d-axis transient voltage", kFluxWeight},
                                     {"psid", "pu", "d-axis subtransient flux", kFluxWeight},
                                     {"psiq", "pu", "q-axis subtransient flux", kFluxWeight}};
  static constexpr int dyr_columns[] = {Tdop, Tdopp, Tqop, Tqopp, H,  D,   Xd,  Xq,
                                        Xdp,  Xqp,   Xdpp, Xqpp,  Xl, S10, S12, Kis};
  static constexpr int raw_resistance = Ra, raw_reactance = -1;

  enum C {
    A,
    B,
    ratio,  ///< Xq/Xd
    kis,
    ra,
    xl,
    dl,  ///< X''d - Xl
    ql,  ///< X''q - Xl
    ad,  ///< (Xd - X''d)/(X'd - X''d)
    aq,
    dd,  ///< X'd - X''d
    dq,
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
  enum M { sn, cs, eq, ed, Id, Iq, kd, kq, scratch };

  static void check(const double* p, const std::string& where, Problems& problems) {
    check_with({name, parameters, p, where, problems}, p);
  }
  /// Checks the parameters of GENTPJ or GENTPF; `p`: values in the order of GENTPJ.
  static void check_with(const shared::ValueCheck& values, const double* p);
  static std::string_view unphysical(const double* p) {
    if (!(p[Xd] > p[Xdp] && p[Xdp] > p[Xdpp] && p[Xdpp] > p[Xl])) return "Xd > X'd > X''d > Xl";
    if (!(p[Xq] >= p[Xqp] && p[Xqp] > p[Xqpp] && p[Xqpp] > p[Xl])) return "Xq >= X'q > X''q > Xl";
    if (!(p[Tdop] > p[Tdopp])) return "T'do > T''do";
    if (p[Tqop] > 0 && !(p[Tqop] > p[Tqopp])) return "T'qo > T''qo";
    if (p[S10] > 0 && !(p[S12] > p[S10])) return "S1.2 > S1.0";
    return "";
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    quadratic_saturation(p[S10], p[S12], c[A], c[B]);
    c[ratio] = p[Xq] / p[Xd];
    c[kis] = p[Kis];
    c[ra] = p[Ra];
    c[xl] = p[Xl];
    c[dl] = p[Xdpp] - p[Xl];
    c[ql] = p[Xqpp] - p[Xl];
    c[dd] = p[Xdp] - p[Xdpp];
    c[dq] = p[Xqp] - p[Xqpp];
    c[ad] = (p[Xd] - p[Xdpp]) / c[dd];
    c[aq] = (p[Xq] - p[Xqpp]) / c[dq];
    c[iTdop] = T(1.0) / p[Tdop];
    c[iTdopp] = T(1.0) / p[Tdopp];
    const auto wound = p[Tqop] > T(0.0);
    c[iTqop] = select(wound, T(1.0) / select(wound, p[Tqop], T(1.0)), T(0.0));
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

  /// Returns the argument u of Se, air-gap flux plus Kis |I| [pu]. `du` receives its derivative for the
  /// current derivatives did, diq.
  template <class T>
  static T magnetisation(const T* c, const T& vd, const T& vq, const T& id, const T& iq, const T& did,
                         const T& diq, T& du) {
    using std::sqrt;
    const T tiny(1e-30);  // [pu^2] keeps the derivative finite at 0
    const T fd = vd + c[ra] * id - c[xl] * iq, fq = vq + c[ra] * iq + c[xl] * id;
    const T flux = sqrt(fd * fd + fq * fq + tiny), amps = sqrt(id * id + iq * iq + tiny);
    du = (fd * (c[ra] * did - c[xl] * diq) + fq * (c[ra] * diq + c[xl] * did)) / flux +
         c[kis] * (id * did + iq * diq) / amps;
    return flux + c[kis] * amps;
  }
  template <class T>
  static T saturation(const T* c, const T& u) {
    return c[B] * square(positive_part(u - c[A])) / u;
  }
  /// Solves the stator equations for Se = sigma: Id, Iq and their derivatives with respect to sigma.
  template <class T>
  static void stator(const T* c, const T& sigma, const T& a, const T& b, T& id, T& iq, T& did, T& diq) {
    const T d = T(1.0) / (T(1.0) + sigma), q = T(1.0) / (T(1.0) + c[ratio] * sigma);
    const T xd = c[xl] + c[dl] * d, xq = c[xl] + c[ql] * q;
    const T over = T(1.0) / (c[ra] * c[ra] + xd * xq);
    id = (c[ra] * a + xq * b) * over;
    iq = (c[ra] * b - xd * a) * over;
    const T da = T(0.0) - c[ratio] * c[ql] * q * q * iq, db = c[dl] * d * d * id;
    did = (c[ra] * da + xq * db) * over;
    diq = (c[ra] * db - xd * da) * over;
  }

  template <class T>
  static void emf(const T* c, const T* x, T* m, T& er, T& ei) {
    sincos(x[delta], m[sn], m[cs]);
    const T w = T(1.0) + c[speed_voltage] * x[speed];
    m[eq] = x[psid] * w;
    m[ed] = T(0.0) - x[psiq] * w;
    er = m[ed] * m[sn] + m[eq] * m[cs];
    ei = m[eq] * m[sn] - m[ed] * m[cs];
  }
  template <class T>
  static void current(const T* c, const T* /*x*/, T* m, Signals<T>& s) {
    // Quadratic convergence: four steps are usual, S1.2 = 1.2 needs seven. A lane whose residual was below
    // the limit before its last step is at rounding level, and does not depend on the steps of the other
    // lanes.
    constexpr int kNewtonSteps = 8;
    constexpr double kFlattest = 0.1;  // lower bound of the residual's derivative, which limits a Newton step
    constexpr double kResidual = 1e-9;
    const T limit(kResidual * kResidual);
    const T vd = s.Vr * m[sn] - s.Vi * m[cs], vq = s.Vr * m[cs] + s.Vi * m[sn];
    const T a = m[ed] - vd, b = m[eq] - vq;
    T id, iq, did, diq, du;
    T sigma(0.0), rest(1.0);
    for (int step = 0; step < kNewtonSteps && any_positive(square(rest) - limit); ++step) {
      stator(c, sigma, a, b, id, iq, did, diq);
      const T u = magnetisation(c, vd, vq, id, iq, did, diq, du);
      const T above = positive_part(u - c[A]), inverse_u = T(1.0) / u;
      const T rise = T(1.0) - c[B] * above * (u + c[A]) * inverse_u * inverse_u * du;
      const T safe = select(rise > T(kFlattest), rise, T(kFlattest));
      const auto open = square(rest) > limit;
      rest = select(open, sigma - c[B] * above * above * inverse_u, rest);
      sigma = select(open, positive_part(sigma - rest / safe), sigma);
    }
    stator(c, sigma, a, b, id, iq, did, diq);
    // Not converged: NaN prevents the integrator from accepting this current.
    const T none(std::numeric_limits<double>::quiet_NaN());
    id = select(square(rest) < limit, id, none);
    s.Ir = id * m[sn] + iq * m[cs];
    s.Ii = iq * m[sn] - id * m[cs];
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    m[Id] = s.Ir * m[sn] - s.Ii * m[cs];
    m[Iq] = s.Ir * m[cs] + s.Ii * m[sn];
    const T vd = s.Vr * m[sn] - s.Vi * m[cs], vq = s.Vr * m[cs] + s.Vi * m[sn];
    T unused;
    const T se = saturation(c, magnetisation(c, vd, vq, m[Id], m[Iq], T(0.0), T(0.0), unused));
    m[kd] = T(1.0) + se;
    m[kq] = T(1.0) + c[ratio] * se;
    s.speed = x[speed];
    const T xd = c[xl] + c[dl] / m[kd], xq = c[xl] + c[ql] / m[kq];
    s.Te = (x[psid] - xd * m[Id]) * m[Iq] - (x[psiq] - xq * m[Iq]) * m[Id];
    s.Ifd = m[kd] * (x[psid] + c[ad] * (x[Eqp] - x[psid]));
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    const T driving = (s.Tm - c[kD] * x[speed]) / (T(1.0) + c[power] * x[speed]);
    dx[delta] = c[W0] * x[speed];
    dx[speed] = (driving - s.Te) * c[i2H];
    dx[Eqp] = (s.Efd - s.Ifd) * c[iTdop];
    dx[Edp] = m[kq] * (x[psiq] - c[aq] * (x[Edp] + x[psiq])) * c[iTqop];
    dx[psid] = (m[kd] * (x[Eqp] - x[psid]) - c[dd] * m[Id]) * c[iTdopp];
    dx[psiq] = (T(0.0) - m[kq] * (x[psiq] + x[Edp]) - c[dq] * m[Iq]) * c[iTqopp];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::atan2;
    // The terminal determines the air-gap flux, and thus Se, before the angle is known.
    T unused;
    const T zero(0.0), se = saturation(c, magnetisation(c, zero - s.Vi, s.Vr, zero - s.Ii, s.Ir, zero, zero,
                                                        unused));  // the same for any orientation of the axes
    const T kd0 = T(1.0) + se, kq0 = T(1.0) + c[ratio] * se;
    const T xqs = p[Xl] + (p[Xq] - p[Xl]) / kq0;  // the q axis lies along V + (Ra + jXqs) I
    x[delta] = atan2(s.Vi + p[Ra] * s.Ii + xqs * s.Ir, s.Vr + p[Ra] * s.Ir - xqs * s.Ii);
    x[speed] = T(0.0);
    T sd, cd;
    sincos(x[delta], sd, cd);
    const T id = s.Ir * sd - s.Ii * cd, iq = s.Ir * cd + s.Ii * sd;
    const T vd = s.Vr * sd - s.Vi * cd, vq = s.Vr * cd + s.Vi * sd;
    x[psid] = vq + p[Ra] * iq + (p[Xl] + c[dl] / kd0) * id;
    x[psiq] = (p[Xl] + c[ql] / kq0) * iq - vd - p[Ra] * id;
    x[Eqp] = x[psid] + c[dd] * id / kd0;
    x[Edp] = T(0.0) - x[psiq] - c[dq] * iq / kq0;
    s.Efd = kd0 * x[psid] + (p[Xd] - p[Xdpp]) * id;
    s.Tm = (vq + p[Ra] * iq) * iq + (vd + p[Ra] * id) * id;
    return {};
  }
};

inline void Model::check_with(const shared::ValueCheck& values, const double* p) {
  values.require_divisors({H, Tdop, Tdopp, Tqopp, Xd, Xdpp, Xqpp});
  values.require_difference(Xdp, Xdpp);
  values.require_difference(Xqp, Xqpp);
  for (const int i : {Xdpp, Xqpp})
    values.refuse(!(p[i] >= p[Xl]), values.text(i, Xl), "only the part above Xl saturates",
                  "give a reactance >= Xl");
  values.require_times({Tqop});
  values.refuse(p[Tqop] == 0 && p[Xqp] != p[Xq], values.text(Tqop, Xqp, Xq),
                "without the transient circuit X'q equals Xq", "give X'q = Xq, or T'qo > 0");
  values.refuse_negative({Kis}, "current adds to saturation");
  values.refuse(!QuadraticSaturation::possible(p[S10], p[S12]), values.text(S10, S12),
                QuadraticSaturation::impossible, QuadraticSaturation::remedy);
}

}  // namespace swingbank::sim::effects::machine_gentpj
