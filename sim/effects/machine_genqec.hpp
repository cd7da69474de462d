#pragma once
// GENQEC: synchronous machine with the rotor circuits of GENROU. All inductances except the leakage saturate
// equally, and the stator current corrects the field current.
//
// As in GENTPJ, saturation and current depend on each other; the solution of GENTPJ is used, with one factor
// for both axes.

#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/value_check.hpp"
#include "sim/effects/machine_gentpj.hpp"

namespace swingbank::sim::effects::machine_genqec {

struct Model {
  using J = machine_gentpj::Model;
  static constexpr std::string_view
      name = "GENQEC",
      title = "synchronous machine, equal saturation of all inductances, corrected field current",
      source =
          "WECC, GENQEC generator dynamic model specification, as in PowerSystems.jl (GENQEC) and InterPSS "
          "(GenqecMachine, github.com/InterPSS-Project/ipss-plugin: equations, columns); PSS/E GENQEC",
      dyr_name = "GENQEC";
  static constexpr Slot slot = Slot::machine;
  static constexpr std::string_view description = R"(
   k = 1 + Se(u), u = |V + (Ra + jXl) I|  (air-gap flux)            X''ds = Xl + (X''d - Xl)/k, X''qs likewise
   Se = B (u - A)^2/u above A, with Se(1.0) = S1.0 and Se(1.2) = S1.2 (SatFunc 1: scaled quadratic);  S1.0 = 0: none
   psi''d =  E'q (X''d - Xl)/(X'd - Xl) + psi1d (X'd - X''d)/(X'd - Xl)
   psi''q = -E'd (X''q - Xl)/(X'q - Xl) + psi2q (X'q - X''q)/(X'q - Xl)
   Vd = -psi''q (1 + w) + X''qs Iq - Ra Id                          (1 + w): speed voltage, not in PSS/E
   Vq =  psi''d (1 + w) - X''ds Id - Ra Iq
   td = psi1d + (X'd - Xl) Id/k - E'q                               T''do dpsi1d/dt = -k td
   tq = psi2q + (X'q - Xl) Iq/k + E'd                               T''qo dpsi2q/dt = -k tq
   Xad Ifd = (k E'q + (Xd - X'd)(Id - k (X'd - X''d)/(X'd - Xl)^2 td))/(1 - Kw Id), Kw Id within -0.4, 0.4
   T'do dE'q/dt = Efd - Xad Ifd
   T'qo dE'd/dt = (Xq - X'q)(Iq - k (X'q - X''q)/(X'q - Xl)^2 tq) - k E'd;    T'qo = 0 (X'q = Xq): E'd = 0
   2H dw/dt = Tm - Te - D w   (PSS/E's convention: (Pm - D w)/(1 + w) - Te)
   Te = (psi''d - X''ds Id) Iq - (psi''q - X''qs Iq) Id
   Without saturation and with Kw = 0 this is GENROU (where X''q = X''d).
)";
  enum P {
    Tdop,
    Tdopp,
    Tqop,
    Tqopp,
    H,
    D,
    Xd,
    Xq,
    Xdp,
    Xqp,
    Xdpp,
    Xqpp,
    Xl,
    S10,
    S12,
    Ra,
    Rcomp,
    Xcomp,
    Kw,
    SatFunc,
    parameter_count
  };
  static constexpr Source defaults_from = J::defaults_from, bounds_from = J::bounds_from;
  static constexpr Source kElsewhere = literature::derived("0 only: IEEEVC is the compensator");
  static constexpr Source kActs =
      literature::own("not 0, so that the stator current acts on the field current");
  static constexpr auto parameters = [] {
    std::array<Parameter, parameter_count> all{};
    for (int i = 0; i < Ra; ++i) all[static_cast<std::size_t>(i)] = J::parameters[i];
    all[Ra] = J::parameters[J::Ra];
    all[Rcomp] = {"Rcomp",          "Rcomp",   "pu", 0.0, 0.0, 0.0, 0.0, "compensating resistance: 0 only",
                  shared::kNothing, kElsewhere};
    all[Xcomp] = {"Xcomp",          "Xcomp",   "pu", 0.0, 0.0, 0.0, 0.0, "compensating reactance: 0 only",
                  shared::kNothing, kElsewhere};
    all[Kw] = {"Kw",    "Kw",
               "pu/pu", 0.1,
               0.0,     1.0,
               0.0,     "field current's correction by Id",
               kActs,   literature::own("clamped beyond Kw Id = 0.4")};
    all[SatFunc] = {"SatFunc",
                    "SatFunc",
                    "code",
                    1.0,
                    1.0,
                    1.0,
                    kNoNullValue,
                    "saturation function: 1 scaled quadratic",
                    literature::own("WECC's usual choice"),
                    shared::kCode};
    return all;
  }();
  static constexpr auto dyr_columns = shared::columns_to<parameter_count - 1>();
  enum X { delta, speed, Eqp, Edp, psi1d, psi2q };
  static constexpr State states[] = {{"delta", "rad", "rotor angle in the synchronous frame"},
                                     {"speed", "pu", "speed deviation", 100.0},
                                     {"Eqp", "pu", "q-axis transient voltage", J::kFluxWeight},
                                     {"Edp", "pu", "d-axis transient voltage", J::kFluxWeight},
                                     {"psi1d", "pu", "d-axis damper flux", J::kFluxWeight},
                                     {"psi2q", "pu", "second q-axis damper flux", J::kFluxWeight}};
  static constexpr int raw_resistance = -1, raw_reactance = -1;
  /// Coefficients of GENTPJ, which GENTPJ's functions require, then the coefficients of the rotor circuits.
  enum C { gd, gq, xdl, xql, dXd, dXq, kd, kq, kw, last };
  static constexpr int own = J::coefficients, coefficients = own + last;
  /// Scratch values of GENTPJ, with kd as the factor of both axes; then psi''d, psi''q, td.
  enum M { pd = J::scratch, pq, td, scratch };
  static constexpr double kMostCorrection = 0.4;

  template <class T>
  static std::array<T, J::Ra + 1> as_gentpj(const T* p) {
    std::array<T, J::Ra + 1> q;
    for (int i = 0; i < Ra; ++i) q[static_cast<std::size_t>(i)] = p[i];
    q[J::Kis] = T(0.0);
    q[J::Ra] = p[Ra];
    return q;
  }
  static void check(const double* p, const std::string& where, Problems& problems);
  static std::string_view unphysical(const double* p) { return J::unphysical(as_gentpj(p).data()); }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    J::prepare(as_gentpj(p).data(), conventions, c);
    c[J::ratio] = T(1.0);
    T* const mine = c + own;
    mine[xdl] = p[Xdp] - p[Xl];
    mine[xql] = p[Xqp] - p[Xl];
    mine[gd] = (p[Xdpp] - p[Xl]) / mine[xdl];
    mine[gq] = (p[Xqpp] - p[Xl]) / mine[xql];
    mine[dXd] = p[Xd] - p[Xdp];
    mine[dXq] = p[Xq] - p[Xqp];
    mine[kd] = (p[Xdp] - p[Xdpp]) / square(mine[xdl]);
    mine[kq] = (p[Xqp] - p[Xqpp]) / square(mine[xql]);
    mine[kw] = p[Kw];
  }
  template <class T>
  static void source_impedance(const T* p, T& r, T& x) {
    r = p[Ra];
    x = p[Xdpp];
  }
  template <class T>
  static void emf(const T* c, const T* x, T* m, T& er, T& ei) {
    const T* const mine = c + own;
    sincos(x[delta], m[J::sn], m[J::cs]);
    m[pd] = x[psi1d] + mine[gd] * (x[Eqp] - x[psi1d]);
    m[pq] = x[psi2q] - mine[gq] * (x[Edp] + x[psi2q]);
    const T w = T(1.0) + c[J::speed_voltage] * x[speed];
    m[J::eq] = m[pd] * w;
    m[J::ed] = T(0.0) - m[pq] * w;
    er = m[J::ed] * m[J::sn] + m[J::eq] * m[J::cs];
    ei = m[J::eq] * m[J::sn] - m[J::ed] * m[J::cs];
  }
  template <class T>
  static void current(const T* c, const T* x, T* m, Signals<T>& s) {
    J::current(c, x, m, s);
  }
  /// Returns Xad Ifd [pu]; `lagging`: td.
  template <class T>
  static T field(const T* c, const T& k, const T& eqp, const T& id, const T& lagging) {
    const T* const mine = c + own;
    const T most(kMostCorrection), correction = clamp(mine[kw] * id, T(0.0) - most, most);
    return (k * eqp + mine[dXd] * (id - k * mine[kd] * lagging)) / (T(1.0) - correction);
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    const T* const mine = c + own;
    m[J::Id] = s.Ir * m[J::sn] - s.Ii * m[J::cs];
    m[J::Iq] = s.Ir * m[J::cs] + s.Ii * m[J::sn];
    const T vd = s.Vr * m[J::sn] - s.Vi * m[J::cs], vq = s.Vr * m[J::cs] + s.Vi * m[J::sn];
    T unused;
    const T se = J::saturation(c, J::magnetisation(c, vd, vq, m[J::Id], m[J::Iq], T(0.0), T(0.0), unused));
    const T k = m[J::kd] = m[J::kq] = T(1.0) + se;
    m[td] = x[psi1d] + mine[xdl] * m[J::Id] / k - x[Eqp];
    s.speed = x[speed];
    const T xd = c[J::xl] + c[J::dl] / k, xq = c[J::xl] + c[J::ql] / k;
    s.Te = (m[pd] - xd * m[J::Id]) * m[J::Iq] - (m[pq] - xq * m[J::Iq]) * m[J::Id];
    s.Ifd = field(c, k, x[Eqp], m[J::Id], m[td]);
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    const T* const mine = c + own;
    const T driving = (s.Tm - c[J::kD] * x[speed]) / (T(1.0) + c[J::power] * x[speed]);
    const T k = m[J::kd], tq = x[psi2q] + mine[xql] * m[J::Iq] / k + x[Edp];
    dx[delta] = c[J::W0] * x[speed];
    dx[speed] = (driving - s.Te) * c[J::i2H];
    dx[Eqp] = (s.Efd - s.Ifd) * c[J::iTdop];
    dx[Edp] = (mine[dXq] * (m[J::Iq] - k * mine[kq] * tq) - k * x[Edp]) * c[J::iTqop];
    dx[psi1d] = T(0.0) - k * m[td] * c[J::iTdopp];
    dx[psi2q] = T(0.0) - k * tq * c[J::iTqopp];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::atan2;
    // The terminal determines the air-gap flux, and thus Se, before the angle is known.
    T unused;
    const T zero(0.0),
        se = J::saturation(c, J::magnetisation(c, zero - s.Vi, s.Vr, zero - s.Ii, s.Ir, zero, zero,
                                               unused));  // the same for any orientation of the axes
    const T k = T(1.0) + se, xqs = p[Xl] + (p[Xq] - p[Xl]) / k;
    x[delta] = atan2(s.Vi + p[Ra] * s.Ii + xqs * s.Ir, s.Vr + p[Ra] * s.Ir - xqs * s.Ii);
    x[speed] = zero;
    T sd, cd;
    sincos(x[delta], sd, cd);
    const T id = s.Ir * sd - s.Ii * cd, iq = s.Ir * cd + s.Ii * sd;
    const T vd = s.Vr * sd - s.Vi * cd, vq = s.Vr * cd + s.Vi * sd;
    x[psi1d] = vq + p[Ra] * iq + p[Xl] * id;  // psi''d - (X''d - Xl) Id/k
    x[Eqp] = x[psi1d] + (p[Xdp] - p[Xl]) * id / k;
    x[Edp] = (p[Xq] - p[Xqp]) * iq / k;
    x[psi2q] = zero - x[Edp] - (p[Xqp] - p[Xl]) * iq / k;
    s.Efd = field(c, k, x[Eqp], id, zero);
    s.Tm = (vq + p[Ra] * iq) * iq + (vd + p[Ra] * id) * id;
    return {};
  }
};

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(name, parameters, p, where, problems);
  values.require_divisors({H, Tdop, Tdopp, Tqopp, Xd, Xdpp, Xqpp});
  values.require_difference(Xdp, Xl);
  values.require_difference(Xqp, Xl);
  for (const int i : {Xdpp, Xqpp})
    values.refuse(!(p[i] >= p[Xl]), values.text(i, Xl), "only the part above Xl saturates",
                  "give a reactance >= Xl");
  values.require_times({Tqop});
  values.refuse(p[Tqop] == 0 && p[Xqp] != p[Xq], values.text(Tqop, Xqp, Xq),
                "without the transient circuit X'q equals Xq", "give X'q = Xq, or T'qo > 0");
  values.refuse_negative({Kw}, "the correction grows with the current");
  for (const int i : {Rcomp, Xcomp})
    values.refuse(p[i] != 0, i, "GENQEC's own compensation is not modelled",
                  "give 0 and add an IEEEVC record");
  values.refuse(p[SatFunc] != 1, SatFunc,
                "of GENQEC's saturation functions only the scaled quadratic (1) is modelled",
                "give 1, or S1.0 = 0 with 1 for no saturation");
  values.refuse(!QuadraticSaturation::possible(p[S10], p[S12]), values.text(S10, S12),
                QuadraticSaturation::impossible, QuadraticSaturation::remedy);
}

}  // namespace swingbank::sim::effects::machine_genqec
