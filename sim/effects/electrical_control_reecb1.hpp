#pragma once
// REECB1: electrical control of a large photovoltaic plant.

#include "sim/core/effect.hpp"
#include "sim/effects/detail/electrical_records.hpp"
#include "sim/effects/detail/record.hpp"

namespace swingbank::sim::effects::electrical_control_reecb1 {

struct Model : renewable::RideThrough<5>, renewable::Regulators<14>, renewable::Orders<23> {
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
  |Ipcmd + j Iqcmd| <= Imax; reduced first: Ipcmd (PQFLAG 0), Iqcmd (PQFLAG 1); Iqmin, Iqmax: limits of Iqcmd
  Vref0 = 0: the voltage at the operating point. The regulated terminal is the unit's own.
)";
  enum P { RemoteBus, PFFLAG, VFLAG, QFLAG, PQFLAG };
  static_assert(PQFLAG + 1 == Vdip && Vref0 + 1 == Tp && Kvi + 1 == Tiq);
  static constexpr Source defaults_from = literature::psid("FourBus_multigen.dyr");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr std::array kCodes = {renewable::record::RemoteBus, renewable::record::PFFLAG,
                                        renewable::record::VFLAG, renewable::record::QFLAG,
                                        renewable::record::PQFLAG};
  static constexpr auto parameters = renewable::joined(kCodes, ride_through, regulators, orders);
  static constexpr auto dyr_columns = shared::columns_to<Tpord>();
  using Core = renewable::ElectricalControl;
  static constexpr int coefficients = Core::coefficients;
  static constexpr auto states = Core::states;

  static void check(const double* p, const std::string& where, Problems& problems) {
    renewable::check_electrical<Model>(shared::ValueCheck(name, parameters, p, where, problems));
  }
  static std::string remark(const double* p) { return Core::remote(p[RemoteBus]); }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    Core::prepare(renewable::electrical_values<Model>(p), c);
  }
  template <class T>
  static void publish(const T*, const T* x, Signals<T>& s) {
    s.Pord = x[Core::Pord];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T Vf = Core::measure(c, x, s, dx);
    const T runs = T(1.0) - renewable::voltage_dip(s.V, c[Core::vdip], c[Core::vup]);
    const T injected = Core::ride_through(c, Vf);
    Core::commands(
        c, x, Vf, Vf, runs, c[Core::pneed] + s.Pext, {c[Core::imax], T(0.0), c[Core::imax]},
        [&](const T& Iq) { return Iq + injected; }, renewable::as_it_is, renewable::as_it_is, s, dx);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    Core::reference(c, s);
    return Core::steady(c, s.V, Core::ride_through(c, s.V), c[Core::vref], T(1.0),
                        {c[Core::imax], T(0.0), c[Core::imax]}, s, x);
  }
};

}  // namespace swingbank::sim::effects::electrical_control_reecb1
