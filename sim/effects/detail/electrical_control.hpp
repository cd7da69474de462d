#pragma once
// Common part of the electrical controls REECA1, REECB1, REECC1 and REECD1: reactive current in one of four
// modes, active current from the ordered power, and the limit of both.
#include <fmt/format.h>

#include <string>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/renewable.hpp"

namespace swingbank::sim::effects::renewable {

/// Returns the reason why an operating point is infeasible: currents [pu] beyond Imax.
inline std::string beyond_imax(double active, double reactive, double most) {
  return fmt::format(
      "the operating point needs currents of {:.4f} (active) and {:.4f} pu (reactive), beyond Imax = {:.4f} pu",
      active, reactive, most);
}

struct ElectricalControl {
  /// Parameters of an effect by their meaning, independent of their order in the effect.
  template <class T>
  struct Values {
    bool pf = false, vflag = false, qflag = false, active_first = false;
    T vdip{}, vup{}, trv{}, dbd1{}, dbd2{}, kqv{}, iqh1{}, iql1{}, vref0{}, tp{}, qmax{}, qmin{}, vmax{},
        vmin{}, kqp{}, kqi{}, kvp{}, kvi{}, tiq{}, dpmax{}, dpmin{}, pmax{}, pmin{}, imax{}, tpord{};
  };
  enum C {
    by_factor,  ///< flags: 1 or 0
    by_q,
    by_v,
    active_first,
    vdip,
    vup,
    iTrv,
    dbd1,
    dbd2,
    kqv,
    iqh1,
    iql1,
    vref,
    iTp,
    qmax,
    qmin,
    vmax,
    vmin,
    kqp,
    kqi,
    kvp,
    kvi,
    iTiq,
    dpmax,
    dpmin,
    pmax,
    pmin,
    imax,
    iTpord,
    tangent,  ///< tangent of the power factor angle
    need,     ///< Qin at the operating point, including the bias if Qext is a voltage
    pneed,    ///< Pext at the operating point
    coefficients
  };
  enum X { Vf, Pf, Vq, Vi, Iqlag, Pord, count };
  static constexpr std::array<State, count> states = {
      State{"Vf", "pu", "measured voltage"},
      State{"Pf", "pu", "measured power"},
      State{.name = "Vq", .unit = "pu", .meaning = "integral of the regulator of Q", .bends = true},
      State{.name = "Vi", .unit = "pu", .meaning = "integral of the regulator of V", .bends = true},
      State{"Iqlag", "pu", "lagged reactive current"},
      State{"Pord", "pu", "ordered power", 1.0, pmin, pmax}};

  template <class T>
  static void prepare(const Values<T>& v, T* c) {
    const auto flag = [](bool on) { return T(on ? 1.0 : 0.0); };
    c[by_factor] = flag(v.pf);
    c[by_q] = flag(v.vflag);
    c[by_v] = flag(v.qflag);
    c[active_first] = flag(v.active_first);
    for (const auto& [to, from] : {std::pair<int, const T*>{vdip, &v.vdip},
                                   {vup, &v.vup},
                                   {dbd1, &v.dbd1},
                                   {dbd2, &v.dbd2},
                                   {kqv, &v.kqv},
                                   {iqh1, &v.iqh1},
                                   {iql1, &v.iql1},
                                   {vref, &v.vref0},
                                   {qmax, &v.qmax},
                                   {qmin, &v.qmin},
                                   {vmax, &v.vmax},
                                   {vmin, &v.vmin},
                                   {kqp, &v.kqp},
                                   {kvp, &v.kvp},
                                   {dpmax, &v.dpmax},
                                   {dpmin, &v.dpmin},
                                   {pmax, &v.pmax},
                                   {pmin, &v.pmin},
                                   {imax, &v.imax}})
      c[to] = *from;
    c[kqi] = v.qflag && v.vflag ? v.kqi : T(0.0);
    c[kvi] = v.qflag ? v.kvi : T(0.0);
    c[iTrv] = inverse(v.trv);
    c[iTp] = inverse(v.tp);
    c[iTiq] = v.qflag ? T(0.0) : inverse(v.tiq);
    c[iTpord] = inverse(v.tpord);
  }
  /// Returns the measured voltage [pu].
  template <class T>
  static T measure(const T* c, const T* x, const Signals<T>& s, T* dx) {
    return lag(c[iTrv], x[Vf], s.V, dx[Vf]);
  }
  template <class T>
  static T ride_through(const T* c, const T& measured) {
    return clamp(c[kqv] * dead_zone(c[vref] - measured, c[dbd1], c[dbd2]), c[iql1], c[iqh1]);
  }
  /// Sets the voltage reference; Vref0 = 0 means the voltage at the operating point.
  template <class T>
  static void reference(T* c, const Signals<T>& s) {
    if (value_of(c[vref]) == 0.0) c[vref] = s.V;
  }
  /// Returns the reactive current without the ride-through contribution [pu]. The limits of the voltage
  /// regulator's output are +-most. `regulated`: the regulated voltage [pu].
  template <class T>
  static T reactive(const T* c, const T* x, const T& measured, const T& regulated, const T& runs,
                    const T& most, Signals<T>& s, T* dx) {
    const T zero(0.0), half(0.5);
    const T power = lag(c[iTp], x[Pf], s.P, dx[Pf]);
    const T Qin = select(c[by_factor] > half, c[tangent] * power, c[need] + s.Qext);
    const T error = clamp(Qin, c[qmin], c[qmax]) - s.Q;
    const T asked = regulator(c[kqp], c[kqi], error, c[vmin], c[vmax], runs, x[Vq], dx[Vq]);
    const T Vcmd = clamp(select(c[by_q] > half, asked, Qin), c[vmin], c[vmax]);
    const T of_voltage = regulator(c[kvp], c[kvi], Vcmd - regulated, zero - most, most, runs, x[Vi], dx[Vi]);
    const T of_power = lag(c[iTiq], x[Iqlag], Qin / at_least_small(measured), dx[Iqlag]);
    dx[Iqlag] = dx[Iqlag] * runs;
    return select(c[by_v] > half, of_voltage, of_power);
  }
  /// Returns the ordered power [pu]; `wanted`: its reference from Pext.
  template <class T>
  static T ordered(const T* c, const T* x, const T& wanted, const T& runs, T* dx) {
    dx[Pord] = runs * clamp((wanted - x[Pord]) * c[iTpord], c[dpmin], c[dpmax]);
    return clamp(select(c[iTpord] > T(0.0), x[Pord], wanted), c[pmin], c[pmax]);
  }
  /// Limits of the currents in addition to Imax [pu].
  template <class T>
  struct Limits {
    T most_p, least_p, most_q;
  };
  /// Computes both commands: s.Tm (active) and s.Efd (reactive). A Model passes three functions. `total` adds
  /// the ride-through contribution to the reactive current. `active` maps the ordered current to the active
  /// current. `active_limit` maps the upper limit of the active current to the limit that applies.
  template <class T, class Total, class Active, class ActiveLimit>
  static void commands(const T* c, const T* x, const T& measured, const T& regulated, const T& runs,
                       const T& wanted, const Limits<T>& limits, const Total& total, const Active& active,
                       const ActiveLimit& active_limit, Signals<T>& s, T* dx) {
    const T zero(0.0), half(0.5);
    const auto p_first = c[active_first] > half;
    const T asked = active(ordered(c, x, wanted, runs, dx) / at_least_small(measured));
    const T first = clamp(asked, limits.least_p, limits.most_p);
    const T most = select(p_first, smaller(limits.most_q, other_current(c[imax], first)), limits.most_q);
    const T Iq = reactive(c, x, measured, regulated, runs, most, s, dx);
    s.Efd = clamp(total(Iq), zero - most, most);
    const T beside = select(p_first, c[imax], other_current(c[imax], s.Efd));
    s.Tm = clamp(asked, larger(limits.least_p, zero - beside), active_limit(smaller(limits.most_p, beside)));
  }
  /// Initialises states and references from the commands. `regulated`: as in reactive(); `injected`: steady
  /// ride-through current; `bias`: added to Qext if it is a voltage; `turning`: factor of Pext (1 or 1 + wg).
  template <class T>
  static std::string steady(T* c, const T& regulated, const T& injected, const T& bias, const T& turning,
                            const Limits<T>& limits, Signals<T>& s, T* x) {
    const double p = value_of(s.Tm), q = value_of(s.Efd), total = value_of(c[imax]);
    if (p > value_of(limits.most_p) || p < value_of(limits.least_p) ||
        std::abs(q) > value_of(limits.most_q) || p * p + q * q > total * total)
      return beyond_imax(p, q, total);
    const T Iq = s.Efd - injected, V = at_least_small(s.V);
    x[Vf] = s.V;
    x[Pf] = s.P;
    x[Pord] = s.Tm * V;
    c[pneed] = x[Pord] / turning;
    x[Iqlag] = Iq;
    x[Vi] = Iq;
    x[Vq] = regulated;
    const bool voltage = value_of(c[by_v]) == 1.0, power = value_of(c[by_q]) == 1.0;
    c[need] = voltage ? (power ? s.Q : regulated) : Iq * V;
    s.Qneed = voltage && !power ? regulated - bias : c[need];
    s.Pneed = c[pneed];
    if (value_of(c[by_factor]) == 1.0) {
      if (value_of(s.P) == 0.0 && value_of(c[need]) != 0.0) return "the power factor is undefined: P = 0 pu";
      c[tangent] = value_of(s.P) == 0.0 ? T(0.0) : c[need] / s.P;
    }
    if (!voltage) return {};
    if (auto why = power ? shared::outside("Qin", c[need], c[qmin], c[qmax]) : ""; !why.empty()) return why;
    return shared::outside("Vcmd", regulated, c[vmin], c[vmax]);
  }

  static std::string remote(double bus) {
    return bus == 0
               ? std::string()
               : fmt::format("it should measure at bus {:g}, but measures at the unit's own terminal", bus);
  }
};

}  // namespace swingbank::sim::effects::renewable
