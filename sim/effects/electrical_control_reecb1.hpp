#pragma once
// REECB1: electrical control of a large photovoltaic plant.
#include <fmt/format.h>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/electrical_control.hpp"

namespace swingbank::sim::effects::electrical_control_reecb1 {

struct Model {
  static constexpr std::string_view
      name = "REECB1",
      title = "electrical control of a photovoltaic plant, type B",
      source =
          "WECC (2014), Central station photovoltaic power plant model validation guideline, REEC_B; "
          "PSS/E REECB1",
      dyr_name = "REECB1";
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
    Tpord
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
      {"Pmin", "Pmin", "pu", 0.0, -99.0, 1.0, kNoNeutral, "lowest Pord"},
      {"Imax", "Imax", "pu", 1.11, 0.1, 99.0, kNoNeutral, "largest current"},
      {"Tpord", "Tpord", "s", 0.02, 0.0, 10.0, kNoNeutral, "lag of Pord (0: none)"}};
  static constexpr int dyr_columns[] = {
      RemoteBus, PFFLAG, VFLAG, QFLAG, PQFLAG, Vdip, Vup, Trv, dbd1, dbd2,  Kqv,   Iqh1, Iql1, Vref0, Tp,
      Qmax,      Qmin,   Vmax,  Vmin,  Kqp,    Kqi,  Kvp, Kvi, Tiq,  dPmax, dPmin, Pmax, Pmin, Imax,  Tpord};
  using Core = renewable::ElectricalControl;
  static constexpr int coefficients = Core::coefficients;
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
  }
  template <class T>
  static void publish(const T*, const T* x, Signals<T>& s) {
    s.Pord = x[Core::Pord];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T Vf = Core::measure(c, x, s, dx);
    const T runs = T(1.0) - voltage_dip_of(c, s);
    const T injected = Core::ride_through(c, Vf);
    const auto as_it_is = [](const T& left) { return left; };
    Core::commands(c, x, Vf, runs, injected, c[Core::pneed] + s.Pext, c[Core::imax], T(0.0), c[Core::imax],
                   as_it_is, s, dx);
  }
  template <class T>
  static T voltage_dip_of(const T* c, const Signals<T>& s) {
    return renewable::voltage_dip(s.V, c[Core::vdip], c[Core::vup]);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    Core::reference(c, s);
    return Core::steady(c, Core::ride_through(c, s.V), c[Core::vref], T(1.0), c[Core::imax], T(0.0),
                        c[Core::imax], s, x);
  }
};

}  // namespace swingbank::sim::effects::electrical_control_reecb1
