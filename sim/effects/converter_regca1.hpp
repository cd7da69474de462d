#pragma once
// REGCA1: converter of a wind or photovoltaic plant or a battery, a controlled current.
#include <fmt/format.h>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/controlled_current.hpp"
#include "sim/effects/detail/renewable.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::converter_regca1 {

struct Model : shared::ControlledCurrent<Model> {
  static constexpr std::string_view name = "REGCA1", title = "converter as a controlled current, type A",
                                    source =
                                        "WECC (2014), Wind plant dynamic modeling guidelines, REGC_A; "
                                        "PSS/E REGCA1",
                                    dyr_name = "REGCA1";
  static constexpr std::string_view description = R"(
  Ipcmd --> [ 1/(1 + s Tg), rise <= rrpwr ] <= LVPL --Ip--> x G(V) --> active current
      LVPL: 0 below Zerox, Lvpl1 above Brkpt, linear between, of V/(1 + s Tfltr)        (Lvplsw = 1)
      G(V): 0 below Lvpnt0, 1 above Lvpnt1, linear between
  Iqcmd --> [ 1/(1 + s Tg), rise <= Iqrmax if Q0 > 0, fall >= Iqrmin if Q0 < 0 ] --Iq-->
      Iq - Khv max(V - Volim, 0) >= Iolim --> reactive current, positive while it delivers Q        (Q0: initial Q)

  I = (active - j reactive) V/|V|, below |V| = 0.01 pu in proportion to |V|
  speed: frequency of the terminal voltage, measured with the lag Tfreq
  Accel belongs to PSS/E's network iteration and is not used.
)";
  enum P {
    Lvplsw,
    Tg,
    Rrpwr,
    Brkpt,
    Zerox,
    Lvpl1,
    Volim,
    Lvpnt1,
    Lvpnt0,
    Iolim,
    Tfltr,
    Khv,
    Iqrmax,
    Iqrmin,
    Accel,
    Tfreq
  };
  static constexpr Source defaults_from = literature::psid("RENA/ThreeBus_REN_A_DEFAULT_FLAG.dyr");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Parameter parameters[] = {
      {"Lvplsw", "Lvplsw", "code", 0.0, 0.0, 1.0, kNoNullValue, "1: low-voltage limit of the active current",
       kAsEffect, renewable::kFlag},
      {"Tg", "Tg", "s", 0.02, 1e-3, 0.5, kNoNullValue, "time constant of the converter"},
      {"Rrpwr", "rrpwr", "pu/s", 10.0, 0.01, 999.0, kNoNullValue, "fastest rise of the active current"},
      {"Brkpt", "Brkpt", "pu", 0.9, 0.0, 1.5, kNoNullValue, "voltage above which LVPL is Lvpl1"},
      {"Zerox", "Zerox", "pu", 0.4, 0.0, 1.0, kNoNullValue, "voltage below which LVPL is 0"},
      upper_limit(
          {"Lvpl1", "Lvpl1", "pu", 1.22, 0.0, 5.0, kNoNullValue, "limit of the active current at Brkpt"}),
      {"Volim", "Volim", "pu", 1.2, 0.8, 2.0, kNoNullValue, "voltage above which Q is absorbed"},
      {"Lvpnt1", "Lvpnt1", "pu", 0.8, 0.0, 1.5, kNoNullValue, "voltage above which G is 1",
       literature::psse("REGCA1")},
      {"Lvpnt0", "Lvpnt0", "pu", 0.4, -1.0, 1.0, kNoNullValue, "voltage below which G is 0",
       literature::psse("REGCA1")},
      lower_limit(
          {"Iolim", "Iolim", "pu", -1.3, -99.0, 0.0, kNoNullValue, "lower limit of the reactive current"}),
      {"Tfltr", "Tfltr", "s", 0.2, 0.0, 1.0, kNoNullValue,
       "lag of the voltage measurement for LVPL (0: none)"},
      {"Khv", "Khv", "pu/pu", 0.0, 0.0, 100.0, 0.0, "reactive current per voltage above Volim"},
      {"Iqrmax", "Iqrmax", "pu/s", 100.0, 0.0, 9999.0, kNoNullValue, "fastest rise of the reactive current"},
      {"Iqrmin", "Iqrmin", "pu/s", -100.0, -9999.0, 0.0, kNoNullValue,
       "fastest fall of the reactive current"},
      {"Accel", "Accel", "code", 0.0, 0.0, 2.0, kNoNullValue,
       "acceleration of PSS/E's network iteration: not used"},
      kTfreq};
  static constexpr int dyr_columns[] = {Lvplsw, Tg,    Rrpwr, Brkpt, Zerox,  Lvpl1,  Volim, Lvpnt1,
                                        Lvpnt0, Iolim, Tfltr, Khv,   Iqrmax, Iqrmin, Accel};
  static constexpr double kFollow = 2e-3;  ///< time constant with which Ip follows LVPL while Ip > LVPL [s]
  enum C {
    iTg,
    rise,
    rest,   ///< kNoLimit if LVPL is switched off, else 0
    most,   ///< Lvpl1
    slope,  ///< slope of LVPL
    zerox,
    volim,
    gain_from,  ///< Lvpnt0
    gain_slope,
    iolim,
    iTfltr,
    khv,
    q_rise,
    q_fall,
    iTfreq,
    per_angle,
    start,  ///< power at the operating point
    coefficients
  };
  enum X { Ip, Iq, Vmeas, Vrlag, Vilag };
  static constexpr State states[] = {{"Ip", "pu", "active current before G"},
                                     {"Iq", "pu", "reactive current before its reduction above Volim"},
                                     {"Vmeas", "pu", "voltage measured for LVPL"},
                                     kVrlag,
                                     kVilag};
  enum M { voltage, limit, scratch };

  static void check(const double* p, const std::string& where, Problems& problems);

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    c[iTg] = T(1.0) / p[Tg];
    c[rise] = p[Rrpwr];
    c[rest] = value_of(p[Lvplsw]) > 0.5 ? T(0.0) : T(renewable::kNoLimit);
    c[most] = p[Lvpl1];
    c[slope] = p[Lvpl1] / (p[Brkpt] - p[Zerox]);
    c[zerox] = p[Zerox];
    c[volim] = p[Volim];
    c[gain_from] = p[Lvpnt0];
    c[gain_slope] = T(1.0) / (p[Lvpnt1] - p[Lvpnt0]);
    c[iolim] = p[Iolim];
    c[iTfltr] = inverse(p[Tfltr]);
    c[khv] = p[Khv];
    c[q_rise] = p[Iqrmax];
    c[q_fall] = p[Iqrmin];
    prepare_frequency(p[Tfreq], conventions, c);
  }
  template <class T>
  static T gain(const T* c, const T& V) {
    return clamp((V - c[gain_from]) * c[gain_slope], T(0.0), T(1.0));
  }
  template <class T>
  static T low_voltage_limit(const T* c, const T* x, const T& V) {
    const T measured = select(c[iTfltr] > T(0.0), x[Vmeas], V);
    return clamp((measured - c[zerox]) * c[slope], T(0.0), c[most]) + c[rest];
  }
  template <class T>
  static void current(const T* c, const T* x, T*, Signals<T>& s) {
    const T V = magnitude(s.Vr, s.Vi);
    const T active = renewable::smaller(x[Ip], low_voltage_limit(c, x, V)) * gain(c, V);
    const T reactive = renewable::larger(x[Iq] - c[khv] * positive_part(V - c[volim]), c[iolim]);
    const T per = T(1.0) / renewable::at_least_small(V);
    s.Ir = (active * s.Vr + reactive * s.Vi) * per;
    s.Ii = (active * s.Vi - reactive * s.Vr) * per;
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    m[voltage] = magnitude(s.Vr, s.Vi);
    m[limit] = low_voltage_limit(c, x, m[voltage]);
    terminal(c, x, m[voltage] * m[voltage], s);
    s.Pext = s.dPref;
    s.Qext = s.dVref;
    s.Paero = c[start];
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    // The rate limit applies to an increase of |Ip|: upward if the converter delivers, downward if it draws.
    const T wanted = (s.Tm - x[Ip]) * c[iTg], none(renewable::kNoLimit);
    const auto draws = x[Ip] < T(0.0);
    const T moves =
        clamp(wanted, select(draws, T(0.0) - c[rise], T(0.0) - none), select(draws, none, c[rise]));
    dx[Ip] = renewable::smaller(moves, (m[limit] - x[Ip]) * T(1.0 / kFollow));
    dx[Iq] = clamp((s.Efd - x[Iq]) * c[iTg], c[q_fall], c[q_rise]);
    dx[Vmeas] = (m[voltage] - x[Vmeas]) * c[iTfltr];
    follow_voltage(c, x, s, dx);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    const T V = magnitude(s.Vr, s.Vi), P = s.Vr * s.Ir + s.Vi * s.Ii, Q = s.Vi * s.Ir - s.Vr * s.Ii;
    const T share = gain(c, V), drawn = c[khv] * positive_part(V - c[volim]);
    if (!(value_of(share) > 0.0))
      return fmt::format("at V = {:.4f} pu it delivers no active current: Lvpnt0 = {:.4f} pu", value_of(V),
                         value_of(c[gain_from]));
    x[Vmeas] = V;
    x[Ip] = P / V / share;
    x[Iq] = Q / V + drawn;
    steady_voltage(s, x);
    const T ceiling = low_voltage_limit(c, x, V);
    if (value_of(x[Ip]) > value_of(ceiling))
      return fmt::format(
          "the operating point needs an active current of {:.4f} pu, but LVPL limits it to {:.4f} pu",
          value_of(x[Ip]), value_of(ceiling));
    if (value_of(x[Iq] - drawn) < value_of(c[iolim]))
      return fmt::format("the operating point needs a reactive current of {:.4f} pu, below Iolim = {:.4f} pu",
                         value_of(x[Iq] - drawn), value_of(c[iolim]));
    if (!(value_of(Q) > 0.0)) c[q_rise] = T(renewable::kNoLimit);
    if (!(value_of(Q) < 0.0)) c[q_fall] = T(-renewable::kNoLimit);
    c[start] = P;
    s.Tm = x[Ip];
    s.Efd = x[Iq];
    s.V = V;
    return {};
  }
};

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(name, parameters, p, where, problems);
  values.require_switches({Lvplsw});
  values.require_positive({Tg, Tfreq, Rrpwr}, "the equations divide by it, or the current could not change");
  values.require_times({Tfltr});
  values.require_above(Brkpt, Zerox, "LVPL must rise with the voltage");
  values.require_above(Lvpnt1, Lvpnt0, "G must rise with the voltage");
  values.refuse_negative({Iqrmax}, "it is the fastest rise");
  values.refuse_positive({Iqrmin}, "it is the fastest fall");
}

}  // namespace swingbank::sim::effects::converter_regca1
