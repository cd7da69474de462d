#pragma once
// REECC1: electrical control of a battery.
#include <fmt/format.h>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/electrical_control.hpp"

namespace swingbank::sim::effects::electrical_control_reecc1 {

struct Model {
  static constexpr std::string_view
      name = "REECC1",
      title = "electrical control of a battery, type C",
      source = "WECC (2015), Battery storage dynamic modeling guideline, REEC_C; PSS/E REECC1",
      dyr_name = "REECC1";
  static constexpr Slot slot = Slot::electrical_control;
  static constexpr std::string_view description = R"(
  Vf = V/(1 + s Trv)    dip: V < Vdip or V > Vup freezes the integrals, Iq and Pord
  Qin = Qext (PFFLAG 0), tan(phi0) P/(1 + s Tp) (PFFLAG 1)
  Qin within Qmin, Qmax - Q --> [ Kqp + Kqi/s, Vmin to Vmax ] --> Vcmd (VFLAG 1);  Qin + Vref0 --> Vcmd (VFLAG 0)
  Vcmd within Vmin, Vmax - Vf --> [ Kvp + Kvi/s, Iqmin to Iqmax ] --> Iq (QFLAG 1)
  Qin/Vf --> [ 1/(1 + s Tiq) ] --> Iq (QFLAG 0)
  Vref0 - Vf --> [ dbd1, dbd2 ] --> x Kqv within Iql1, Iqh1 --> Iqv          Iqcmd = Iq + Iqv
  Pext --> [ 1/(1 + s Tpord), rate dPmin to dPmax, Pmin to Pmax ] --Pord--> /Vf --> Ipcmd
  |Ipcmd + j Iqcmd| <= Imax; the one that yields: Ipcmd (PQFLAG 0), Iqcmd (PQFLAG 1)
  Iqcmd within VDL1(Vf), Ipcmd within +-VDL2(Vf): straight between the points (Vq, Iq) and (Vp, Ip), as far as their
      voltages rise; all 0: none
  The state of charge stays what it is at the start: a battery at SOCmin does not deliver, one at SOCmax does not draw.
  Vref0 = 0: the voltage at the operating point. The regulated terminal is the unit's own.
)";
  enum P {
    RemoteBus,
    PFFLAG,
    VFLAG,
    QFLAG,
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
    Tp,
    Qmax,
    Qmin,
    Vmax,
    Vmin,
    Kqp,
    Kqi,
    Kvp,
    Kvi,
    Tiq,
    dPmax,
    dPmin,
    Pmax,
    Pmin,
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
    Ip4,
    T,
    SOCini,
    SOCmax,
    SOCmin
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
      {"Tp", "Tp", "s", 0.05, 0.0, 10.0, kNoNeutral, "measurement of the power (0: none)"},
      {"Qmax", "Qmax", "pu", 0.44, -1.0, 99.0, kNoNeutral, "highest Qin"},
      {"Qmin", "Qmin", "pu", -0.44, -99.0, 1.0, kNoNeutral, "lowest Qin"},
      {"Vmax", "Vmax", "pu", 1.05, 0.5, 99.0, kNoNeutral, "highest Vcmd"},
      {"Vmin", "Vmin", "pu", 0.9, -99.0, 1.2, kNoNeutral, "lowest Vcmd"},
      {"Kqp", "Kqp", "pu/pu", 0.0, 0.0, 100.0, 0.0, "regulator of Q, proportional gain"},
      {"Kqi", "Kqi", "1/s", 0.01, 0.0, 500.0, 0.0, "regulator of Q, integral gain"},
      {"Kvp", "Kvp", "pu/pu", 10.0, 0.0, 200.0, 0.0, "regulator of V, proportional gain"},
      {"Kvi", "Kvi", "1/s", 60.0, 0.0, 1000.0, 0.0, "regulator of V, integral gain"},
      {"Tiq", "Tiq", "s", 0.02, 0.0, 1.0, kNoNeutral, "lag of Iq (0: none)"},
      {"dPmax", "dPmax", "pu/s", 99.0, 0.0, 999.0, kNoNeutral, "fastest rise of Pord"},
      {"dPmin", "dPmin", "pu/s", -99.0, -999.0, 0.0, kNoNeutral, "fastest fall of Pord"},
      {"Pmax", "Pmax", "pu", 1.0, 0.0, 99.0, kNoNeutral, "highest Pord"},
      {"Pmin", "Pmin", "pu", -1.0, -99.0, 1.0, kNoNeutral, "lowest Pord"},
      {"Imax", "Imax", "pu", 1.11, 0.1, 99.0, kNoNeutral, "largest current"},
      {"Tpord", "Tpord", "s", 0.02, 0.0, 10.0, kNoNeutral, "lag of Pord (0: none)"},
      {"Vq1", "Vq1", "pu", -1.0, -1.0, 99.0, kNoNeutral, "voltage of point 1 of the limit of Iq"},
      {"Iq1", "Iq1", "pu", 1.11, 0.0, 99.0, kNoNeutral, "reactive current there"},
      {"Vq2", "Vq2", "pu", 2.0, -1.0, 99.0, kNoNeutral, "voltage of point 2 of the limit of Iq"},
      {"Iq2", "Iq2", "pu", 1.11, 0.0, 99.0, kNoNeutral, "reactive current there"},
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
      {"Ip4", "Ip4", "pu", 0.0, 0.0, 99.0, kNoNeutral, "active current there"},
      {"T", "T", "s", 14400.0, 1.0, 1e6, kNoNeutral,
       "time in which rated power empties it: longer than any run",
       literature::own("a battery of four hours")},
      {"SOCini", "SOCini", "pu", 0.5, 0.0, 1.0, kNoNeutral, "state of charge at the start",
       literature::own("half full"), literature::derived("a part of the whole")},
      {"SOCmax", "SOCmax", "pu", 0.8, 0.0, 1.0, kNoNeutral, "largest state of charge",
       literature::own("WECC's typical range, 0.8 to 1"), literature::derived("a part of the whole")},
      {"SOCmin", "SOCmin", "pu", 0.2, 0.0, 1.0, kNoNeutral, "smallest state of charge",
       literature::own("WECC's typical range, 0 to 0.2"), literature::derived("a part of the whole")}};
  static constexpr int dyr_columns[] = {
      RemoteBus, PFFLAG, VFLAG, QFLAG, PQFLAG, Vdip, Vup, Trv, dbd1,   dbd2,   Kqv,   Iqh1,  Iql1,
      Vref0,     Tp,     Qmax,  Qmin,  Vmax,   Vmin, Kqp, Kqi, Kvp,    Kvi,    Tiq,   dPmax, dPmin,
      Pmax,      Pmin,   Imax,  Tpord, Vq1,    Iq1,  Vq2, Iq2, Vq3,    Iq3,    Vq4,   Iq4,   Vp1,
      Ip1,       Vp2,    Ip2,   Vp3,   Ip3,    Vp4,  Ip4, T,   SOCini, SOCmax, SOCmin};
  using Core = renewable::ElectricalControl;
  enum C {
    of_q = Core::coefficients,
    of_p = of_q + renewable::kByVoltage,
    delivers = of_p + renewable::kByVoltage,  ///< 0 where the battery is empty
    draws,                                    ///< -1, or 0 where it is full
    coefficients
  };
  static constexpr auto states = Core::states;

  static void check(const double* p, const std::string& where, Problems& problems) {
    Core::check_flags(parameters, p, {PFFLAG, VFLAG, QFLAG, PQFLAG}, where, problems);
    Core::check_times(parameters, p, {Trv, Tp, Tiq, Tpord}, where, problems);
    Core::check_ranges(parameters, p,
                       {{Vup, Vdip}, {Iqh1, Iql1}, {Qmax, Qmin}, {Vmax, Vmin}, {dPmax, dPmin}, {Pmax, Pmin}},
                       where, problems);
    Core::check_signs(parameters, p, {dbd2, Kqv, Kqp, Kqi, Kvp, Kvi, Imax}, {dbd1}, where, problems);
  }
  static std::string_view unphysical(const double*) { return ""; }
  static std::string remark(const double* p) { return Core::remote(p[RemoteBus]); }

  template <class S>
  static void prepare(const S* p, const Conventions&, S* c) {
    Core::Values<S> v;
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
    v.qmax = p[Qmax];
    v.qmin = p[Qmin];
    v.vmax = p[Vmax];
    v.vmin = p[Vmin];
    v.kqp = p[Kqp];
    v.kqi = p[Kqi];
    v.kvp = p[Kvp];
    v.kvi = p[Kvi];
    v.tiq = p[Tiq];
    v.dpmax = p[dPmax];
    v.dpmin = p[dPmin];
    v.pmax = p[Pmax];
    v.pmin = p[Pmin];
    v.imax = p[Imax];
    v.tpord = p[Tpord];
    Core::prepare(v, c);
    renewable::prepare_by_voltage(p + Vq1, p[Imax], c + of_q);
    renewable::prepare_by_voltage(p + Vp1, p[Imax], c + of_p);
    c[delivers] = select(p[SOCini] > p[SOCmin], S(1.0), S(0.0));
    c[draws] = select(p[SOCini] < p[SOCmax], S(-1.0), S(0.0));
  }
  template <class S>
  static void publish(const S*, const S* x, Signals<S>& s) {
    s.Pord = x[Core::Pord];
  }
  template <class S>
  static S most_active(const S* c, const S& V) {
    return c[delivers] * renewable::by_voltage(c + of_p, V);
  }
  template <class S>
  static void evaluate(const S* c, const S* x, Signals<S>& s, S* dx) {
    const S Vf = Core::measure(c, x, s, dx);
    const S runs = S(1.0) - renewable::voltage_dip(s.V, c[Core::vdip], c[Core::vup]);
    const S lowest = c[draws] * renewable::by_voltage(c + of_p, Vf);
    const auto as_it_is = [](const S& left) { return left; };
    Core::commands(c, x, Vf, runs, Core::ride_through(c, Vf), c[Core::pneed] + s.Pext, most_active(c, Vf),
                   lowest, renewable::by_voltage(c + of_q, Vf), as_it_is, s, dx);
  }
  template <class S>
  static std::string steady(const S*, S* c, Signals<S>& s, S* x) {
    Core::reference(c, s);
    return Core::steady(c, Core::ride_through(c, s.V), c[Core::vref], S(1.0), most_active(c, s.V),
                        c[draws] * renewable::by_voltage(c + of_p, s.V), renewable::by_voltage(c + of_q, s.V),
                        s, x);
  }
};

}  // namespace swingbank::sim::effects::electrical_control_reecc1
