#pragma once
// REGCB1: converter of a wind or photovoltaic plant or a battery, a voltage behind an impedance that drives
// the commanded current.
#include <string>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/behind_impedance.hpp"

namespace swingbank::sim::effects::converter_regcb1 {

struct Model : shared::BehindImpedance<Model> {
  static constexpr std::string_view
      name = "REGCB1",
      title = "converter as a voltage behind an impedance, type B",
      source =
          "WECC, REGC_B, as in InterPSS (Regcb1Model, github.com/InterPSS-Project/ipss-plugin: equations, "
          "columns); PSS/E REGCB1, REGCBU1",
      dyr_name = "REGCB1";
  static constexpr std::string_view variant_of = "REGCA1";
  static constexpr std::string_view description = R"(
  Ipcmd, Iqcmd within Imax; reduced first: Ipcmd (pqFlag 0), Iqcmd (pqFlag 1)
  Ipcmd --> [ 1/(1 + s Tg), rise <= rrpwr ] --> Ip (rateFlag 0)
  Ipcmd Vf --> [ 1/(1 + s Tg), rise <= rrpwr ] --> /Vf --> Ip (rateFlag 1)          Vf = V/(1 + s Tfltr)
  Iqcmd --> [ 1/(1 + s Tg), rise <= Iqrmax if Q0 > 0, fall >= Iqrmin if Q0 < 0 ] --> Iq        Q0: initial Q
  V + Re Ip + Xe Iq --> [ 1/(1 + s Te) ] --> Ed          Xe Ip - Re Iq --> [ 1/(1 + s Te) ] --> Eq
  I = ((Ed - V) + j Eq) V/|V|/(Re + j Xe), within Imax as the commands are; below |V| = 0.01 pu in proportion to |V|
      The limit of the current without priority is at least 0.025 Imax, so that it stays differentiable where the
      other current uses all of Imax.
  speed: frequency of the terminal voltage, measured with the lag Tfreq
  Re and Xe are given in the .raw: ZSORCE.
)";
  enum P { rateFlag, pqFlag, Tg, Tfltr, Iqrmax, Iqrmin, rrpwr, Te, Imax, Re, Xe, Tfreq };
  static constexpr Parameter parameters[] = {
      kRateFlag,
      kPqFlag,
      kTg,
      kTfltr,
      kIqrmax,
      kIqrmin,
      kRrpwr,
      {"Te", "Te", "s", 0.01, 0.0, 0.5, kNoNullValue, "lag of the inner voltage (0: none)",
       literature::own("half of Tg: the inner loop is the faster one")},
      kImax,
      kRe,
      kXe,
      kTfreq};
  static constexpr int dyr_columns[] = {rateFlag, pqFlag, Tg, Tfltr, Iqrmax, Iqrmin, rrpwr, Te, Imax};
  static constexpr int raw_resistance = Re, raw_reactance = Xe;
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
    start,  ///< power at the operating point
    coefficients
  };
  enum X { Ip, Iq, Vf, Ed, Eq, Vrlag, Vilag };
  static constexpr State states[] = {{"Ip", "pu", "active current, or the power for rateFlag 1"},
                                     {"Iq", "pu", "reactive current"},
                                     {"Vf", "pu", "measured voltage"},
                                     {"Ed", "pu", "inner voltage along V"},
                                     {"Eq", "pu", "inner voltage perpendicular to V"},
                                     kVrlag,
                                     kVilag};
  enum M { voltage, target_d, target_q, scratch };

  static void check(const double* p, const std::string& where, Problems& problems) {
    check_common(p, where, problems);
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    prepare_common(p, conventions, c);
  }
  template <class T>
  static void current(const T* c, const T* x, T*, Signals<T>& s) {
    const T V = magnitude(s.Vr, s.Vi);
    T d, q;
    inner_voltage(c, x, V, d, q);
    const auto lags = c[iTe] > T(0.0);
    T p, reactive;
    impedance_currents(c, select(lags, x[Ed], d) - V, select(lags, x[Eq], q), p, reactive);
    within(c, p, reactive);
    const T per = T(1.0) / renewable::at_least_small(V);
    s.Ir = (p * s.Vr + reactive * s.Vi) * per;
    s.Ii = (p * s.Vi - reactive * s.Vr) * per;
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    m[voltage] = magnitude(s.Vr, s.Vi);
    inner_voltage(c, x, m[voltage], m[target_d], m[target_q]);
    terminal(c, x, squared_magnitude(s.Vr, s.Vi), s);
    pass_references(c, s);
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    follow_commands(c, x, m[voltage], s, dx);
    dx[Ed] = (m[target_d] - x[Ed]) * c[iTe];
    dx[Eq] = (m[target_q] - x[Eq]) * c[iTe];
    follow_voltage(c, x, s, dx);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    const T V = magnitude(s.Vr, s.Vi);
    T p, q;
    if (auto why = steady_commands(c, V, p, q, s, x); !why.empty()) return why;
    x[Ed] = V;
    x[Eq] = T(0.0);
    add_drop(c, p, q, x[Ed], x[Eq]);
    return {};
  }

 private:
  /// Computes the inner voltage that drives the lagged currents [pu].
  template <class T>
  static void inner_voltage(const T* c, const T* x, const T& V, T& d, T& q) {
    d = V;
    q = T(0.0);
    add_drop(c, lagged_active(c, x, V), x[Iq], d, q);
  }
};

}  // namespace swingbank::sim::effects::converter_regcb1
