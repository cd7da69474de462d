#pragma once
// REGCB1: the converter of a wind or photovoltaic plant or a battery, as a voltage behind its impedance that
// drives the current commanded.
#include <utility>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/controlled_current.hpp"
#include "sim/effects/detail/electrical_control.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::converter_regcb1 {

struct Model : shared::ControlledCurrent<Model> {
  using Core = renewable::ElectricalControl;  // for what its check() asks
  static constexpr std::string_view
      name = "REGCB1",
      title = "converter as a voltage behind an impedance, type B",
      source =
          "WECC, REGC_B, as in InterPSS (Regcb1Model, github.com/InterPSS-Project/ipss-plugin: equations, "
          "columns); PSS/E REGCB1, REGCBU1",
      dyr_name = "REGCB1";
  static constexpr std::string_view variant_of = "REGCA1";
  static constexpr std::string_view description = R"(
  Ipcmd, Iqcmd within Imax; the one that yields: Ipcmd (pqFlag 0), Iqcmd (pqFlag 1)
  Ipcmd --> [ 1/(1 + s Tg), rise <= rrpwr ] --> Ip (rateFlag 0)
  Ipcmd Vf --> [ 1/(1 + s Tg), rise <= rrpwr ] --> /Vf --> Ip (rateFlag 1)          Vf = V/(1 + s Tfltr)
  Iqcmd --> [ 1/(1 + s Tg), rise <= Iqrmax if Q0 > 0, fall >= Iqrmin if Q0 < 0 ] --> Iq
  V + Re Ip + Xe Iq --> [ 1/(1 + s Te) ] --> Ed          Xe Ip - Re Iq --> [ 1/(1 + s Te) ] --> Eq
  I = ((Ed - V) + j Eq) V/|V|/(Re + j Xe), within Imax as the commands are; below |V| = 0.01 pu in proportion to |V|
      What the leading current leaves of Imax to the other does not fall below 0.025 Imax, so that the current has a
      slope where the leading one takes all.
  speed: frequency of the terminal voltage, measured with the lag Tfreq
  Re and Xe stand in the .raw: ZSORCE.
)";
  enum P { rateFlag, pqFlag, Tg, Tfltr, Iqrmax, Iqrmin, rrpwr, Te, Imax, Re, Xe, Tfreq };
  static constexpr Source standards_from = literature::own("as REGCA1's");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Parameter parameters[] = {
      {"rateFlag", "rateFlag", "code", 0.0, 0.0, 1.0, kNoNeutral,
       "0: the active current rises by rrpwr, 1: the power", kAsEffect, renewable::kFlag},
      {"pqFlag", "pqFlag", "code", 0.0, 0.0, 1.0, kNoNeutral, "at Imax 0: P yields, 1: Q yields", kAsEffect,
       renewable::kFlag},
      {"Tg", "Tg", "s", 0.02, 1e-3, 0.5, kNoNeutral, "time constant of the converter"},
      {"Tfltr", "Tfltr", "s", 0.2, 0.0, 1.0, kNoNeutral,
       "measurement of the voltage for rateFlag 1 (0: none)"},
      {"Iqrmax", "Iqrmax", "pu/s", 100.0, 0.0, 9999.0, kNoNeutral, "fastest rise of the reactive current"},
      {"Iqrmin", "Iqrmin", "pu/s", -100.0, -9999.0, 0.0, kNoNeutral, "fastest fall of the reactive current"},
      {"rrpwr", "rrpwr", "pu/s", 10.0, 0.01, 999.0, kNoNeutral,
       "fastest rise of the active current or power"},
      {"Te", "Te", "s", 0.01, 0.0, 0.5, kNoNeutral, "lag of the inner voltage (0: none)",
       literature::own("half of Tg: the inner loop is the faster one")},
      {"Imax", "Imax", "pu", 1.3, 0.1, 99.0, kNoNeutral, "largest current"},
      {"Re", "Re", "pu", 0.0, 0.0, 0.5, kNoNeutral, "source resistance", shared::kNeglected},
      {"Xe", "Xe", "pu", 0.25, 0.01, 2.0, kNoNeutral, "source reactance",
       literature::own("InterPSS's for aggregated converters")},
      kTfreq};
  static constexpr int dyr_columns[] = {rateFlag, pqFlag, Tg, Tfltr, Iqrmax, Iqrmin, rrpwr, Te, Imax};
  static constexpr int raw_resistance = Re, raw_reactance = Xe;
  /// Of Imax: from where on what is left to the other current falls along its tangent, not its circle.
  static constexpr double kTangent = 0.05;
  enum C {
    of_power,
    p_first,
    iTg,
    iTfltr,
    q_rise,
    q_fall,
    rise,
    iTe,
    most,
    r,
    x_e,
    admittance,  ///< 1/|Z|^2
    iTfreq,
    per_angle,
    coefficients
  };
  enum X { Ip, Iq, Vf, Ed, Eq, Vrlag, Vilag };
  static constexpr State states[] = {{"Ip", "pu", "active current, or the power for rateFlag 1"},
                                     {"Iq", "pu", "reactive current"},
                                     {"Vf", "pu", "measured voltage"},
                                     {"Ed", "pu", "inner voltage along V"},
                                     {"Eq", "pu", "inner voltage across V"},
                                     kVrlag,
                                     kVilag};
  enum M { voltage, target_d, target_q, scratch };

  static void check(const double* p, const std::string& where, Problems& problems) {
    Core::check_flags(parameters, p, {rateFlag, pqFlag}, where, problems);
    Core::check_times(parameters, p, {Tfltr, Te}, where, problems);
    Core::check_signs(parameters, p, {Iqrmax, Re}, {Iqrmin}, where, problems);
    for (const int i : {Tg, rrpwr, Imax, Xe, Tfreq})
      if (!(p[i] > 0))
        problems.add(Core::value(parameters, p, i), where,
                     "the equations divide by it or stand still without it", "give a value > 0");
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    for (const auto& [to, from] : {std::pair<int, int>{of_power, rateFlag},
                                   {p_first, pqFlag},
                                   {q_rise, Iqrmax},
                                   {q_fall, Iqrmin},
                                   {rise, rrpwr},
                                   {most, Imax},
                                   {r, Re},
                                   {x_e, Xe}})
      c[to] = p[from];
    for (const auto& [to, from] : {std::pair<int, int>{iTg, Tg}, {iTfltr, Tfltr}, {iTe, Te}})
      c[to] = inverse(p[from]);
    c[admittance] = T(1.0) / (p[Re] * p[Re] + p[Xe] * p[Xe]);
    prepare_frequency(p[Tfreq], conventions, c);
  }
  template <class T>
  static void current(const T* c, const T* x, T*, Signals<T>& s) {
    const T V = magnitude(s);
    T d, q;
    inner_voltage(c, x, V, d, q);
    const auto lags = c[iTe] > T(0.0);
    d = select(lags, x[Ed], d) - V;
    q = select(lags, x[Eq], q);
    T p = (c[r] * d + c[x_e] * q) * c[admittance], reactive = (c[x_e] * d - c[r] * q) * c[admittance];
    within(c, p, reactive);
    const T per = T(1.0) / renewable::at_least_small(V);
    s.Ir = (p * s.Vr + reactive * s.Vi) * per;
    s.Ii = (p * s.Vi - reactive * s.Vr) * per;
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    m[voltage] = magnitude(s);
    inner_voltage(c, x, m[voltage], m[target_d], m[target_q]);
    terminal(c, x, square_of_voltage(s), s);
    s.Pext = s.dPref;
    s.Qext = s.dVref;
    s.Paero = s.Te;
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    const T V = lag(c[iTfltr], x[Vf], m[voltage], dx[Vf]);
    T p = s.Tm, q = s.Efd;
    within(c, p, q);
    const T wanted = (select(c[of_power] > T(0.5), p * V, p) - x[Ip]) * c[iTg], none(renewable::kNoLimit);
    const auto draws = x[Ip] < T(0.0);
    dx[Ip] = clamp(wanted, select(draws, T(0.0) - c[rise], T(0.0) - none), select(draws, none, c[rise]));
    dx[Iq] = clamp((q - x[Iq]) * c[iTg], c[q_fall], c[q_rise]);
    dx[Ed] = (m[target_d] - x[Ed]) * c[iTe];
    dx[Eq] = (m[target_q] - x[Eq]) * c[iTe];
    follow_voltage(c, x, s, dx);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    const T V = magnitude(s), P = s.Vr * s.Ir + s.Vi * s.Ii, Q = s.Vi * s.Ir - s.Vr * s.Ii, p = P / V,
            q = Q / V;
    const double active = value_of(p), reactive = value_of(q), total = value_of(c[most]);
    if (active * active + reactive * reactive > total * total)
      return renewable::beyond_imax(active, reactive, total);
    x[Vf] = V;
    x[Ip] = select(c[of_power] > T(0.5), P, p);
    x[Iq] = q;
    x[Ed] = V + c[r] * p + c[x_e] * q;
    x[Eq] = c[x_e] * p - c[r] * q;
    if (!(value_of(Q) > 0.0)) c[q_rise] = T(renewable::kNoLimit);
    if (!(value_of(Q) < 0.0)) c[q_fall] = T(-renewable::kNoLimit);
    steady_voltage(s, x);
    s.Tm = p;
    s.Efd = q;
    s.V = V;
    return {};
  }

 private:
  /// The inner voltage that drives the lagged currents.
  template <class T>
  static void inner_voltage(const T* c, const T* x, const T& V, T& d, T& q) {
    const T measured = renewable::at_least_small(select(c[iTfltr] > T(0.0), x[Vf], V));
    const T active = select(c[of_power] > T(0.5), x[Ip] / measured, x[Ip]);
    d = V + c[r] * active + c[x_e] * x[Iq];
    q = c[x_e] * active - c[r] * x[Iq];
  }
  /// What the current `leading` leaves to the other one.
  template <class T>
  static T left(const T* c, const T& leading) {
    using std::sqrt;
    const T square = c[most] * c[most] - leading * leading, knee = T(kTangent) * c[most];
    const auto on_circle = square > knee * knee;
    return select(on_circle, sqrt(select(on_circle, square, T(1.0))), (square + knee * knee) / (knee + knee));
  }
  /// Brings both currents within Imax, the leading one as it is as far as it can be.
  template <class T>
  static void within(const T* c, T& p, T& q) {
    const auto p_leads = c[p_first] > T(0.5);
    const T first = clamp(select(p_leads, p, q), T(0.0) - c[most], c[most]), room = left(c, first);
    const T second = clamp(select(p_leads, q, p), T(0.0) - room, room);
    p = select(p_leads, first, second);
    q = select(p_leads, second, first);
  }
};

}  // namespace swingbank::sim::effects::converter_regcb1
