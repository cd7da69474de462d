#pragma once
// REECC1: electrical control of a battery.

#include "sim/core/effect.hpp"
#include "sim/effects/detail/electrical_records.hpp"
#include "sim/effects/detail/record.hpp"

namespace swingbank::sim::effects::electrical_control_reecc1 {

struct Model : renewable::RideThrough<5>, renewable::Regulators<14>, renewable::Orders<23> {
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
  |Ipcmd + j Iqcmd| <= Imax; reduced first: Ipcmd (PQFLAG 0), Iqcmd (PQFLAG 1); Iqmin, Iqmax: limits of Iqcmd
  Iqcmd within VDL1(Vf), Ipcmd within +-VDL2(Vf): linear between the points (Vq, Iq) and (Vp, Ip), up to the last
      rising voltage; all 0: no limit
  The state of charge is constant: a battery at SOCmin does not deliver, one at SOCmax does not draw.
  Vref0 = 0: the voltage at the operating point. The regulated terminal is the unit's own.
)";
  enum P {
    RemoteBus,
    PFFLAG,
    VFLAG,
    QFLAG,
    PQFLAG,
    Vq1 = Tpord + 1,
    Vp1 = Vq1 + 8,
    T = Vp1 + 8,
    SOCini,
    SOCmax,
    SOCmin
  };
  static_assert(PQFLAG + 1 == Vdip && Vref0 + 1 == Tp && Kvi + 1 == Tiq);
  static constexpr Source defaults_from = literature::psid("FourBus_multigen.dyr");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr std::array kCodes = {renewable::record::RemoteBus, renewable::record::PFFLAG,
                                        renewable::record::VFLAG, renewable::record::QFLAG,
                                        renewable::record::PQFLAG};
  static constexpr std::array kBehind = {
      Parameter{"T", "T", "s", 14400.0, 1.0, 1e6, kNoNullValue,
                "discharge time at rated power (without effect)", literature::own("a battery of four hours")},
      Parameter{"SOCini", "SOCini", "pu", 0.5, 0.0, 1.0, kNoNullValue, "initial state of charge",
                literature::own("half full"), literature::derived("a fraction")},
      upper_limit({"SOCmax", "SOCmax", "pu", 0.8, 0.0, 1.0, kNoNullValue, "largest state of charge",
                   literature::own("WECC's typical range, 0.8 to 1"), literature::derived("a fraction")}),
      lower_limit({"SOCmin", "SOCmin", "pu", 0.2, 0.0, 1.0, kNoNullValue, "smallest state of charge",
                   literature::own("WECC's typical range, 0 to 0.2"), literature::derived("a fraction")})};
  static constexpr auto parameters = [] {
    auto all = renewable::joined(kCodes, ride_through, regulators, orders,
                                 renewable::limit_points<4>(1.11, 1.11), kBehind);
    all[Pmin] = shared::with(all[Pmin], -1.0);
    return all;
  }();
  static constexpr auto dyr_columns = shared::columns_to<SOCmin>();
  using Core = renewable::ElectricalControl;
  enum C {
    of_q = Core::coefficients,
    of_p = of_q + renewable::kByVoltage<>,
    delivers = of_p + renewable::kByVoltage<>,  ///< 1, or 0 if the battery is empty
    draws,                                      ///< -1, or 0 if the battery is full
    coefficients
  };
  static constexpr auto states = Core::states;

  static void check(const double* p, const std::string& where, Problems& problems) {
    renewable::check_electrical<Model>(shared::ValueCheck(name, parameters, p, where, problems));
  }
  static std::string remark(const double* p) { return Core::remote(p[RemoteBus]); }

  template <class S>
  static void prepare(const S* p, const Conventions&, S* c) {
    Core::prepare(renewable::electrical_values<Model>(p), c);
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
    const S injected = Core::ride_through(c, Vf);
    Core::commands(
        c, x, Vf, Vf, runs, c[Core::pneed] + s.Pext,
        {most_active(c, Vf), lowest, renewable::by_voltage(c + of_q, Vf)},
        [&](const S& Iq) { return Iq + injected; }, renewable::as_it_is, renewable::as_it_is, s, dx);
  }
  template <class S>
  static std::string steady(const S*, S* c, Signals<S>& s, S* x) {
    Core::reference(c, s);
    return Core::steady(c, s.V, Core::ride_through(c, s.V), c[Core::vref], S(1.0),
                        {most_active(c, s.V), c[draws] * renewable::by_voltage(c + of_p, s.V),
                         renewable::by_voltage(c + of_q, s.V)},
                        s, x);
  }
};

}  // namespace swingbank::sim::effects::electrical_control_reecc1
