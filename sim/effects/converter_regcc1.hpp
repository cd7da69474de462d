#pragma once
// REGCC1: converter of a wind or photovoltaic plant or a battery, a voltage behind an impedance with a
// phase-locked loop and an inner current control.
#include <cmath>
#include <string>
#include <utility>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/behind_impedance.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::converter_regcc1 {

struct Model : shared::BehindImpedance<Model> {
  static constexpr std::string_view
      name = "REGCC1",
      title = "converter as a voltage behind an impedance with its phase-locked loop, type C",
      source =
          "WECC, REGC_C (memo of 2023-02-16), as in GridPACK 0a2544d (regcc1: equations, columns of the .dyr) "
          "and Dynawo 52d69a4 (REGCc, REGCcParameters: limits, typical values); PSS/E REGCC1",
      dyr_name = "REGCC1";
  static constexpr std::string_view variant_of = "REGCA1";
  static constexpr std::string_view description = R"(
  Phase-locked loop (GridPACK; limits of the integral too: Dynawo), phi: its angle
      V exp(-j phi) = Vd + j Vq          I exp(-j phi) = Id - j Iout
      Vq --> [ Kppll + Kipll/s, within wmin..wmax ] --> [ 1/s ] --> phi
      both are frozen while |V| < Vpllfrz (Dynawo's UPllFrz; 0: never)
  Ipcmd, Iqcmd within Imax; reduced first: Ipcmd (pqFlag 0), Iqcmd (pqFlag 1)
  Ipcmd --> [ 1/(1 + s Tg), rise <= rrpwr ] --> Ip (rateFlag 0)
  Ipcmd Vf --> [ 1/(1 + s Tg), rise <= rrpwr ] --> /Vf --> Ip (rateFlag 1)          Vf = V/(1 + s Tfltr)
  Iqcmd --> [ 1/(1 + s Tg), rise <= Iqrmax if Q0 > 0, fall >= Iqrmin if Q0 < 0 ] --> Iq        Q0: initial Q
  Current control (GridPACK; within Imax: Dynawo; priority: as in REGCB1)
      Ip - Id --> [ Kip + Kii/s ] --> up          Iq - Iout --> [ Kip + Kii/s ] --> uq
      Vd + Re up + Xe uq --> [ 1/(1 + s Te) ] --> Ed          Vq + Xe up - Re uq --> [ 1/(1 + s Te) ] --> Eq
  I = ((Ed - Vd) + j (Eq - Vq)) exp(j phi)/(Re + j Xe), within Imax along and across phi as the commands are
      The limit of the current without priority is at least 0.025 Imax, as in REGCB1.
      Te = 0: the currents are up and uq, in closed form (Kip Ip + integral)/(1 + Kip), within Imax.
  speed: frequency of the terminal voltage, measured with the lag Tfreq
  Re and Xe are given in the .raw: ZSORCE. The order of the .dyr is GridPACK's: REGCB1's columns, then Kip to wmin.
      PSS/E's own order is not public; Vpllfrz has no column and is given in plant files.
  WECC's model has no Tg: PowerWorld uses four time steps instead; Tg is GridPACK's.
  Characteristic polynomial of the current: Te s^2 + (1 + Kip) s + Kii. With the defaults it decays with a time
      constant of 20 ms (Tg) and has a damping of 0.7; with Kip = 10 its fastest time constant is 1.8 ms.
      Te = 0: (1 + Kip) s + Kii.
)";
  enum P {
    rateFlag,
    pqFlag,
    Tg,
    Tfltr,
    Iqrmax,
    Iqrmin,
    rrpwr,
    Te,
    Imax,
    Kip,
    Kii,
    Kppll,
    Kipll,
    wmax,
    wmin,
    Re,
    Xe,
    Tfreq,
    Vpllfrz
  };
  static constexpr Source kTypical = literature::own(
      "best damping within the typical values in Dynawo's REGCcParameters (Kip 1 to 10, Kii 20 to 100, Kppll "
      "1 to 10, Kipll 500 to 3000, limits of 1 to 10 rad/s)");
  static constexpr Parameter parameters[] = {
      kRateFlag,
      kPqFlag,
      kTg,
      kTfltr,
      kIqrmax,
      kIqrmin,
      kRrpwr,
      {"Te", "Te", "s", 0.02, 0.0, 0.5, kNoNullValue, "lag of the inner voltage (0: none)",
       literature::own("GridPACK's; Dynawo gives 0 to 0.02 s as typical")},
      kImax,
      {"Kip", "Kip", "pu/pu", 1.0, 0.0, 20.0, kNoNullValue, "proportional gain of the current control",
       kTypical},
      {"Kii", "Kii", "1/s", 100.0, 0.0, 1000.0, kNoNullValue, "integral gain of the current control",
       kTypical},
      {"Kppll", "Kppll", "rad/s/pu", 10.0, 0.0, 100.0, kNoNullValue,
       "proportional gain of the phase-locked loop", kTypical},
      {"Kipll", "Kipll", "rad/s^2/pu", 500.0, 0.0, 10000.0, kNoNullValue,
       "integral gain of the phase-locked loop", kTypical},
      {"wmax", "wmax", "rad/s", 10.0, 0.0, 100.0, kNoNullValue, "upper limit of the loop's speed deviation",
       kTypical},
      {"wmin", "wmin", "rad/s", -10.0, -100.0, 0.0, kNoNullValue, "lower limit of the loop's speed deviation",
       kTypical},
      kRe,
      kXe,
      kTfreq,
      {"Vpllfrz", "Vpllfrz", "pu", 0.0, 0.0, 0.9, 0.0,
       "voltage below which the phase-locked loop is frozen (0: never)",
       literature::own("no column of the .dyr; Dynawo gives 0.1 to 0.5 as typical")}};
  static constexpr int dyr_columns[] = {rateFlag, pqFlag, Tg,  Tfltr, Iqrmax, Iqrmin, rrpwr, Te,
                                        Imax,     Kip,    Kii, Kppll, Kipll,  wmax,   wmin};
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
    kip,
    kii,
    closed,  ///< 1/(1 + Kip)
    kppll,
    kipll,
    w_most,
    w_least,
    frozen,
    iTfreq,
    per_angle,
    start,  ///< power at the operating point
    coefficients
  };
  // Named phi because the reference integrator treats a state named delta as a rotor angle.
  enum X { Ip, Iq, Vf, Sp, Sq, Ed, Eq, phi, w, Vrlag, Vilag };
  static constexpr State states[] = {
      {"Ip", "pu", "active current, or the power for rateFlag 1"},
      {"Iq", "pu", "reactive current"},
      {"Vf", "pu", "measured voltage"},
      {.name = "Sp", .unit = "pu", .meaning = "integral of the active current's control", .bends = true},
      {.name = "Sq", .unit = "pu", .meaning = "integral of the reactive current's control", .bends = true},
      {"Ed", "pu", "inner voltage along phi"},
      {"Eq", "pu", "inner voltage perpendicular to phi"},
      {"phi", "rad", "angle of the phase-locked loop in the synchronous frame"},
      {.name = "w",
       .unit = "rad/s",
       .meaning = "integral of the phase-locked loop",
       .weight = 0.1,  // its error acts through the angle, within a quarter of the loop's period, 0.07 s
       .bends = true},
      kVrlag,
      kVilag};
  enum M { voltage, scratch };

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    check_common(p, where, problems);
    values.refuse_negative({Kip, Kii, Kppll, Kipll, wmax, Vpllfrz});
    values.refuse_positive({wmin});
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    prepare_common(p, conventions, c);
    for (const auto& [to, from] : {std::pair<int, int>{kip, Kip},
                                   {kii, Kii},
                                   {kppll, Kppll},
                                   {kipll, Kipll},
                                   {w_most, wmax},
                                   {w_least, wmin},
                                   {frozen, Vpllfrz}})
      c[to] = p[from];
    c[closed] = T(1.0) / (T(1.0) + p[Kip]);
  }
  template <class T>
  static void current(const T* c, const T* x, T*, Signals<T>& s) {
    const Frame<T> frame(x[phi]);
    T p, reactive;
    impedance_currents(c, x[Ed] - frame.along(s.Vr, s.Vi), x[Eq] - frame.across(s.Vr, s.Vi), p, reactive);
    const auto lags = c[iTe] > T(0.0);
    p = select(lags, p, (c[kip] * lagged_active(c, x, magnitude(s.Vr, s.Vi)) + x[Sp]) * c[closed]);
    reactive = select(lags, reactive, (c[kip] * x[Iq] + x[Sq]) * c[closed]);
    within(c, p, reactive);
    s.Ir = p * frame.cosine + reactive * frame.sine;
    s.Ii = p * frame.sine - reactive * frame.cosine;
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    m[voltage] = magnitude(s.Vr, s.Vi);
    terminal(c, x, squared_magnitude(s.Vr, s.Vi), s);
    pass_references(c, s);
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    follow_commands(c, x, m[voltage], s, dx);
    const Frame<T> frame(x[phi]);
    T d = frame.along(s.Vr, s.Vi), q = frame.across(s.Vr, s.Vi);
    lock(c, x, m[voltage], q, dx);
    T up, uq;
    control(c, x, lagged_active(c, x, m[voltage]) - frame.along(s.Ir, s.Ii), x[Iq] + frame.across(s.Ir, s.Ii),
            up, uq, dx);
    add_drop(c, up, uq, d, q);
    dx[Ed] = (d - x[Ed]) * c[iTe];
    dx[Eq] = (q - x[Eq]) * c[iTe];
    follow_voltage(c, x, s, dx);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    using std::atan2;
    const T V = magnitude(s.Vr, s.Vi);
    T p, q;
    if (auto why = steady_commands(c, V, p, q, s, x); !why.empty()) return why;
    x[Sp] = p;
    x[Sq] = q;
    x[Ed] = V;
    x[Eq] = T(0.0);
    add_drop(c, p, q, x[Ed], x[Eq]);
    x[phi] = atan2(s.Vi, s.Vr);
    x[w] = T(0.0);
    return {};
  }

 private:
  /// Reference frame of the phase-locked loop.
  template <class T>
  struct Frame {
    T sine, cosine;
    explicit Frame(const T& angle) { sincos(angle, sine, cosine); }
    [[nodiscard]] T along(const T& re, const T& im) const { return re * cosine + im * sine; }
    [[nodiscard]] T across(const T& re, const T& im) const { return im * cosine - re * sine; }
  };
  /// Computes the derivatives of the phase-locked loop, which drives the voltage component `across` to zero.
  template <class T>
  static void lock(const T* c, const T* x, const T& V, const T& across, T* dx) {
    const T zero(0.0), one(1.0), per_band(1.0 / renewable::kDipBand);
    const T runs = one - clamp((c[frozen] - V) * per_band, zero, one);
    dx[phi] =
        runs * renewable::regulator(c[kppll], c[kipll], across, c[w_least], c[w_most], runs, x[w], dx[w]);
  }
  /// Computes the currents up, uq that the inner voltage is to drive, from the errors of the active and
  /// reactive current [pu].
  template <class T>
  static void control(const T* c, const T* x, const T& error_p, const T& error_q, T& up, T& uq, T* dx) {
    const T zero(0.0), one(1.0);
    T most_p, most_q;
    limits(c, c[kip] * error_p + x[Sp], c[kip] * error_q + x[Sq], most_p, most_q);
    up = renewable::regulator(c[kip], c[kii], error_p, zero - most_p, most_p, one, x[Sp], dx[Sp]);
    uq = renewable::regulator(c[kip], c[kii], error_q, zero - most_q, most_q, one, x[Sq], dx[Sq]);
  }
};

}  // namespace swingbank::sim::effects::converter_regcc1
