#pragma once
// REECA1: electrical control of a wind turbine or photovoltaic plant, with current limits by voltage.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/electrical_control.hpp"

namespace swingbank::sim::effects::electrical_control_reeca1 {

struct Model {
  static constexpr std::string_view name = "REECA1",
                                    title = "electrical control of a wind or photovoltaic plant, type A",
                                    source =
                                        "WECC (2014), Wind plant dynamic modeling guidelines, REEC_A; "
                                        "PSS/E REECA1",
                                    dyr_name = "REECA1";
  static constexpr Slot slot = Slot::electrical_control;
  static constexpr std::string_view description = R"(
  Vf = V/(1 + s Trv)    dip: V < Vdip or V > Vup freezes the integrals, Iq and Pord
  Qin = Qext (PFFLAG 0), tan(phi0) P/(1 + s Tp) (PFFLAG 1)
  Qin within QMax, QMin - Q --> [ Kqp + Kqi/s, VMIN to VMAX ] --> Vcmd (VFLAG 1);  Qin + Vbias --> Vcmd (VFLAG 0)
  Vcmd within VMIN, VMAX - Vf --> [ Kvp + Kvi/s, Iqmin to Iqmax ] --> Iq (QFLAG 1)
  Qin/Vf --> [ 1/(1 + s Tiq) ] --> Iq (QFLAG 0)
  Vref0 - Vf --> [ dbd1, dbd2 ] --> x Kqv within Iql1, Iqh1 --> Iqv       Iqcmd = Iq + Iqv in a dip, and for |Thld|
      after it Iq + Iqv (Thld < 0) or Iq + Iqfrz (Thld > 0); otherwise Iq
  Pext (x (1 + wg) if PFLAG = 1) --> [ 1/(1 + s Tpord), rate dPmin to dPmax, PMIN to PMAX ] --Pord--> /Vf --> Ipcmd
  Iqcmd within VDL1(Vf), Ipcmd within VDL2(Vf): straight between the points (Vq, Iq) and (Vp, Ip), as far as their
      voltages rise; all 0: none. Ipcmd's limit stays for Thld2 after a dip.
  |Ipcmd + j Iqcmd| <= Imax; the one that yields: Ipcmd (PQFLAG 0), Iqcmd (PQFLAG 1)
  Vref0 = 0: the voltage at the operating point. The regulated terminal is the unit's own.
)";
  enum P {
    RemoteBus,
    PFFLAG,
    VFLAG,
    QFLAG,
    PFLAG,
    PQFLAG,
    Vdip,
    Vup,
    Trv,
    dbd1,
    dbd2,
    Kqv,
    Iqh1,
    Iql1,
    Vref0,
    Iqfrz,
    Thld,
    Thld2,
    Tp,
    QMax,
    QMin,
    VMAX,
    VMIN,
    Kqp,
    Kqi,
    Kvp,
    Kvi,
    Vbias,
    Tiq,
    dPmax,
    dPmin,
    PMAX,
    PMIN,
    Imax,
    Tpord,
    Vq1,
    Iq1,
    Vq2,
    Iq2,
    Vq3,
    Iq3,
    Vq4,
    Iq4,
    Vp1,
    Ip1,
    Vp2,
    Ip2,
    Vp3,
    Ip3,
    Vp4,
    Ip4
  };
  static constexpr Source standards_from = literature::psid("FourBus_multigen.dyr");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Parameter parameters[] = {
      {"RemoteBus", "remote bus", "code", 0.0, 0.0, 999997.0, 0.0, "regulated bus (0: the terminal)",
       kAsEffect, renewable::kBus},
      {"PFFLAG", "PFFLAG", "code", 0.0, 0.0, 1.0, kNoNeutral, "1: holds the power factor, 0: follows Qext",
       kAsEffect, renewable::kFlag},
      {"VFLAG", "VFLAG", "code", 1.0, 0.0, 1.0, kNoNeutral, "1: a regulator of Q makes Vcmd, 0: Qext does",
       kAsEffect, renewable::kFlag},
      {"QFLAG", "QFLAG", "code", 0.0, 0.0, 1.0, kNoNeutral, "1: a regulator of V makes Iq, 0: Q over V does",
       kAsEffect, renewable::kFlag},
      {"PFLAG", "PFLAG", "code", 0.0, 0.0, 1.0, kNoNeutral, "1: Pext times the generator's speed", kAsEffect,
       renewable::kFlag},
      {"PQFLAG", "PQFLAG", "code", 0.0, 0.0, 1.0, kNoNeutral, "at Imax 0: P yields, 1: Q yields", kAsEffect,
       renewable::kFlag},
      {"Vdip", "Vdip", "pu", -99.0, -99.0, 1.2, kNoNeutral, "voltage below which there is a dip"},
      {"Vup", "Vup", "pu", 99.0, 0.8, 99.0, kNoNeutral, "voltage above which there is a dip"},
      {"Trv", "Trv", "s", 0.02, 0.0, 1.0, kNoNeutral, "measurement of the voltage (0: none)"},
      {"dbd1", "dbd1", "pu", 0.0, -1.0, 0.0, 0.0, "lower edge of the dead-band of Iqv"},
      {"dbd2", "dbd2", "pu", 0.0, 0.0, 1.0, 0.0, "upper edge of the dead-band of Iqv"},
      {"Kqv", "Kqv", "pu/pu", 0.0, 0.0, 100.0, 0.0, "reactive current per voltage error: ride-through"},
      {"Iqh1", "Iqh1", "pu", 1.1, 0.0, 99.0, kNoNeutral, "highest Iqv"},
      {"Iql1", "Iql1", "pu", -1.1, -99.0, 0.0, kNoNeutral, "lowest Iqv"},
      {"Vref0", "Vref0", "pu", 0.0, 0.0, 1.5, kNoNeutral, "reference of Iqv (0: the voltage at the start)"},
      {"Iqfrz", "Iqfrz", "pu", 0.0, -2.0, 2.0, 0.0, "Iqv for Thld after a dip"},
      {"Thld", "Thld", "s", 0.0, -10.0, 10.0, 0.0, "how long after a dip Iqfrz (> 0) or Iqv (< 0) goes on"},
      {"Thld2", "Thld2", "s", 0.0, 0.0, 10.0, 0.0, "how long after a dip the limit of Ipcmd stays"},
      {"Tp", "Tp", "s", 0.05, 0.0, 10.0, kNoNeutral, "measurement of the power (0: none)"},
      {"QMax", "QMax", "pu", 0.44, -1.0, 99.0, kNoNeutral, "highest Qin"},
      {"QMin", "QMin", "pu", -0.44, -99.0, 1.0, kNoNeutral, "lowest Qin"},
      {"VMAX", "VMAX", "pu", 1.05, 0.5, 99.0, kNoNeutral, "highest Vcmd"},
      {"VMIN", "VMIN", "pu", 0.9, -99.0, 1.2, kNoNeutral, "lowest Vcmd"},
      {"Kqp", "Kqp", "pu/pu", 0.0, 0.0, 100.0, 0.0, "regulator of Q, proportional gain"},
      {"Kqi", "Kqi", "1/s", 0.01, 0.0, 500.0, 0.0, "regulator of Q, integral gain"},
      {"Kvp", "Kvp", "pu/pu", 10.0, 0.0, 200.0, 0.0, "regulator of V, proportional gain"},
      {"Kvi", "Kvi", "1/s", 60.0, 0.0, 1000.0, 0.0, "regulator of V, integral gain"},
      {"Vbias", "Vbias", "pu", 0.0, -2.0, 2.0, kNoNeutral, "added to a Qext that is a voltage"},
      {"Tiq", "Tiq", "s", 0.02, 0.0, 1.0, kNoNeutral, "lag of Iq (0: none)"},
      {"dPmax", "dPmax", "pu/s", 99.0, 0.0, 999.0, kNoNeutral, "fastest rise of Pord"},
      {"dPmin", "dPmin", "pu/s", -99.0, -999.0, 0.0, kNoNeutral, "fastest fall of Pord"},
      {"PMAX", "PMAX", "pu", 1.0, 0.0, 99.0, kNoNeutral, "highest Pord"},
      {"PMIN", "PMIN", "pu", 0.0, -99.0, 1.0, kNoNeutral, "lowest Pord"},
      {"Imax", "Imax", "pu", 1.11, 0.1, 99.0, kNoNeutral, "largest current"},
      {"Tpord", "Tpord", "s", 0.02, 0.0, 10.0, kNoNeutral, "lag of Pord (0: none)"},
      {"Vq1", "Vq1", "pu", -1.0, -1.0, 99.0, kNoNeutral, "voltage of point 1 of the limit of Iq"},
      {"Iq1", "Iq1", "pu", 1.45, 0.0, 99.0, kNoNeutral, "reactive current there"},
      {"Vq2", "Vq2", "pu", 2.0, -1.0, 99.0, kNoNeutral, "voltage of point 2 of the limit of Iq"},
      {"Iq2", "Iq2", "pu", 1.45, 0.0, 99.0, kNoNeutral, "reactive current there"},
      {"Vq3", "Vq3", "pu", 0.0, -1.0, 99.0, kNoNeutral, "voltage of point 3 of the limit of Iq"},
      {"Iq3", "Iq3", "pu", 0.0, 0.0, 99.0, kNoNeutral, "reactive current there"},
      {"Vq4", "Vq4", "pu", 0.0, -1.0, 99.0, kNoNeutral, "voltage of point 4 of the limit of Iq"},
      {"Iq4", "Iq4", "pu", 0.0, 0.0, 99.0, kNoNeutral, "reactive current there"},
      {"Vp1", "Vp1", "pu", -1.0, -1.0, 99.0, kNoNeutral, "voltage of point 1 of the limit of Ip"},
      {"Ip1", "Ip1", "pu", 1.11, 0.0, 99.0, kNoNeutral, "active current there"},
      {"Vp2", "Vp2", "pu", 2.0, -1.0, 99.0, kNoNeutral, "voltage of point 2 of the limit of Ip"},
      {"Ip2", "Ip2", "pu", 1.11, 0.0, 99.0, kNoNeutral, "active current there"},
      {"Vp3", "Vp3", "pu", 0.0, -1.0, 99.0, kNoNeutral, "voltage of point 3 of the limit of Ip"},
      {"Ip3", "Ip3", "pu", 0.0, 0.0, 99.0, kNoNeutral, "active current there"},
      {"Vp4", "Vp4", "pu", 0.0, -1.0, 99.0, kNoNeutral, "voltage of point 4 of the limit of Ip"},
      {"Ip4", "Ip4", "pu", 0.0, 0.0, 99.0, kNoNeutral, "active current there"}};
  static constexpr int dyr_columns[] = {
      RemoteBus, PFFLAG, VFLAG, QFLAG, PFLAG, PQFLAG, Vdip, Vup,  Trv,   dbd1, dbd2, Kqv, Iqh1,
      Iql1,      Vref0,  Iqfrz, Thld,  Thld2, Tp,     QMax, QMin, VMAX,  VMIN, Kqp,  Kqi, Kvp,
      Kvi,       Vbias,  Tiq,   dPmax, dPmin, PMAX,   PMIN, Imax, Tpord, Vq1,  Iq1,  Vq2, Iq2,
      Vq3,       Iq3,    Vq4,   Iq4,   Vp1,   Ip1,    Vp2,  Ip2,  Vp3,   Ip3,  Vp4,  Ip4};
  using Core = renewable::ElectricalControl;
  static constexpr double kFollow =
      2e-3;  ///< in which timers are set and the limit to be kept is followed [s]
  static constexpr double kFading = 1e-3;  ///< over which what is kept after a dip fades [s]
  enum C {
    of_q = Core::coefficients,
    of_p = of_q + renewable::kByVoltage,
    turns = of_p + renewable::kByVoltage,  ///< PFLAG
    frozen,                                ///< Iqfrz where Thld > 0
    goes_on,                               ///< 1 where Thld < 0
    hold,                                  ///< |Thld|
    hold_p,
    follows,  ///< 1/kFollow, 0 where nothing is to be kept
    none,
    coefficients
  };
  enum X { after = Core::count, after_p, kept };
  static constexpr auto states = [] {
    std::array<State, Core::count + 3> all{};
    std::copy(Core::states.begin(), Core::states.end(), all.begin());
    all[after] = {.name = "after",
                  .unit = "s",
                  .meaning = "time left of Thld",
                  .weight = 0.1,
                  .low = none,
                  .bends = true};
    all[after_p] = {.name = "after_p",
                    .unit = "s",
                    .meaning = "time left of Thld2",
                    .weight = 0.1,
                    .low = none,
                    .bends = true};
    all[kept] = {"kept", "pu", "limit of Ipcmd in the last dip", 0.1};
    return all;
  }();

  static void check(const double* p, const std::string& where, Problems& problems) {
    Core::check_flags(parameters, p, {PFFLAG, VFLAG, QFLAG, PFLAG, PQFLAG}, where, problems);
    Core::check_times(parameters, p, {Trv, Tp, Tiq, Tpord, Thld2}, where, problems);
    Core::check_ranges(parameters, p,
                       {{Vup, Vdip}, {Iqh1, Iql1}, {QMax, QMin}, {VMAX, VMIN}, {dPmax, dPmin}, {PMAX, PMIN}},
                       where, problems);
    Core::check_signs(parameters, p, {dbd2, Kqv, Kqp, Kqi, Kvp, Kvi, Imax}, {dbd1}, where, problems);
  }
  static std::string_view unphysical(const double*) { return ""; }
  static std::string remark(const double* p) { return Core::remote(p[RemoteBus]); }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    Core::Values<T> v;
    v.pf = value_of(p[PFFLAG]) > 0.5;
    v.vflag = value_of(p[VFLAG]) > 0.5;
    v.qflag = value_of(p[QFLAG]) > 0.5;
    v.active_first = value_of(p[PQFLAG]) > 0.5;
    v.vdip = p[Vdip];
    v.vup = p[Vup];
    v.trv = p[Trv];
    v.dbd1 = p[dbd1];
    v.dbd2 = p[dbd2];
    v.kqv = p[Kqv];
    v.iqh1 = p[Iqh1];
    v.iql1 = p[Iql1];
    v.vref0 = p[Vref0];
    v.tp = p[Tp];
    v.qmax = p[QMax];
    v.qmin = p[QMin];
    v.vmax = p[VMAX];
    v.vmin = p[VMIN];
    v.kqp = p[Kqp];
    v.kqi = p[Kqi];
    v.kvp = p[Kvp];
    v.kvi = p[Kvi];
    v.tiq = p[Tiq];
    v.dpmax = p[dPmax];
    v.dpmin = p[dPmin];
    v.pmax = p[PMAX];
    v.pmin = p[PMIN];
    v.imax = p[Imax];
    v.tpord = p[Tpord];
    Core::prepare(v, c);
    renewable::prepare_by_voltage(p + Vq1, p[Imax], c + of_q);
    renewable::prepare_by_voltage(p + Vp1, p[Imax], c + of_p);
    c[turns] = p[PFLAG];
    const T zero(0.0);
    c[frozen] = select(p[Thld] > zero, p[Iqfrz], zero);
    c[goes_on] = select(p[Thld] < zero, T(1.0), zero);
    c[hold] = select(p[Thld] < zero, zero - p[Thld], p[Thld]);
    c[hold_p] = p[Thld2];
    c[follows] = select(p[Thld2] > zero, T(1.0 / kFollow), zero);
    c[none] = zero;
  }
  template <class T>
  static void publish(const T*, const T* x, Signals<T>& s) {
    s.Pord = x[Core::Pord];
  }
  /// Set to `whole` in a dip; runs down to 0 after it. Returns 1 while it runs after a dip.
  template <class T>
  static T timer(const T& dip, const T& whole, const T& x, T& dx) {
    const T zero(0.0), one(1.0);
    dx = dip * (whole - x) * T(1.0 / kFollow) - (one - dip);  // to the state's lower limit
    return (one - dip) * clamp(x * T(1.0 / kFading), zero, one);
  }
  template <class T>
  static T turning(const T* c, const Signals<T>& s) {
    return T(1.0) + c[turns] * s.wg;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T one(1.0), Vf = Core::measure(c, x, s, dx);
    const T dip = renewable::voltage_dip(s.V, c[Core::vdip], c[Core::vup]);
    const T later = timer(dip, c[hold], x[after], dx[after]);
    const T rides = Core::ride_through(c, Vf);
    const T injected = dip * rides + later * (c[frozen] + c[goes_on] * rides);
    const T stays = timer(dip, c[hold_p], x[after_p], dx[after_p]);
    const auto held = [&](const T& left) {
      dx[kept] = (one - stays) * (left - x[kept]) * c[follows];
      return left + stays * (x[kept] - left);
    };
    Core::commands(c, x, Vf, one - dip, injected, (c[Core::pneed] + s.Pext) * turning(c, s),
                   renewable::by_voltage(c + of_p, Vf), T(0.0), renewable::by_voltage(c + of_q, Vf), held, s,
                   dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    Core::reference(c, s);
    if (value_of(renewable::voltage_dip(s.V, c[Core::vdip], c[Core::vup])) > 0.0)
      return fmt::format("V = {:.4f} pu is a voltage dip: Vdip = {:g}, Vup = {:g} pu", value_of(s.V),
                         value_of(c[Core::vdip]), value_of(c[Core::vup]));
    const T most_p = renewable::by_voltage(c + of_p, s.V), most_q = renewable::by_voltage(c + of_q, s.V);
    x[after] = x[after_p] = T(0.0);
    const T left = renewable::smaller(most_p, renewable::other_current(c[Core::imax], s.Efd));
    x[kept] = select(c[Core::active_first] > T(0.5), most_p, left);
    return Core::steady(c, T(0.0), p[Vbias], turning(c, s), most_p, T(0.0), most_q, s, x);
  }
};

}  // namespace swingbank::sim::effects::electrical_control_reeca1
