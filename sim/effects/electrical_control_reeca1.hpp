#pragma once
// REECA1: electrical control of a wind turbine or photovoltaic plant, with voltage-dependent current limits.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/electrical_records.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::electrical_control_reeca1 {

struct Model : renewable::RideThrough<6>, renewable::Regulators<18>, renewable::Orders<28> {
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
  Iqcmd within VDL1(Vf), Ipcmd within VDL2(Vf): linear between the points (Vq, Iq) and (Vp, Ip), up to the last
      rising voltage; all 0: no limit. Ipcmd's limit is kept for Thld2 after a dip.
  |Ipcmd + j Iqcmd| <= Imax; reduced first: Ipcmd (PQFLAG 0), Iqcmd (PQFLAG 1); Iqmin, Iqmax: limits of Iqcmd
  Vref0 = 0: the voltage at the operating point. The regulated terminal is the unit's own.
)";
  enum P {
    RemoteBus,
    PFFLAG,
    VFLAG,
    QFLAG,
    PFLAG,
    PQFLAG,
    Iqfrz = Vref0 + 1,
    Thld,
    Thld2,
    Vbias = Kvi + 1,
    Vq1 = Tpord + 1,
    Vp1 = Vq1 + 8,
    Ip4 = Vp1 + 7
  };
  static_assert(PQFLAG + 1 == Vdip && Thld2 + 1 == Tp && Vbias + 1 == Tiq);
  static constexpr Source defaults_from = literature::psid("FourBus_multigen.dyr");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr std::array kCodes = {renewable::record::RemoteBus, renewable::record::PFFLAG,
                                        renewable::record::VFLAG,     renewable::record::QFLAG,
                                        renewable::record::PFLAG,     renewable::record::PQFLAG};
  static constexpr std::array kAfterDip = {renewable::record::Iqfrz, renewable::record::Thld,
                                           renewable::record::Thld2};
  static constexpr std::array kBias = {
      Parameter{"Vbias", "Vbias", "pu", 0.0, -2.0, 2.0, kNoNullValue, "added to a Qext that is a voltage"}};
  static constexpr auto parameters = [] {
    auto all = renewable::joined(kCodes, ride_through, kAfterDip, regulators, kBias, orders,
                                 renewable::limit_points<4>(1.45, 1.11));
    for (const auto& [i, guide] : {std::pair<int, std::string_view>{Qmax, "QMax"},
                                   {Qmin, "QMin"},
                                   {Vmax, "VMAX"},
                                   {Vmin, "VMIN"},
                                   {Pmax, "PMAX"},
                                   {Pmin, "PMIN"}})
      all[static_cast<std::size_t>(i)] = shared::renamed(all[static_cast<std::size_t>(i)], guide);
    return all;
  }();
  static constexpr auto dyr_columns = shared::columns_to<Ip4>();
  using Core = renewable::ElectricalControl;
  enum C {
    of_q = Core::coefficients,
    of_p = of_q + renewable::kByVoltage<>,
    turns = of_p + renewable::kByVoltage<>,  ///< PFLAG
    frozen,                                  ///< Iqfrz if Thld > 0
    goes_on,                                 ///< 1 if Thld < 0
    hold,                                    ///< |Thld|
    hold_p,
    follows,  ///< 1/kFollow, 0 if no value is to be kept
    none,
    coefficients
  };
  enum X { after = Core::count, after_p, kept };
  static constexpr auto states = [] {
    std::array<State, Core::count + 3> all{};
    std::copy(Core::states.begin(), Core::states.end(), all.begin());
    all[after] = {.name = "after",
                  .unit = "s",
                  .meaning = "remaining time of Thld",
                  .weight = 0.1,
                  .low = none,
                  .bends = true};
    all[after_p] = {.name = "after_p",
                    .unit = "s",
                    .meaning = "remaining time of Thld2",
                    .weight = 0.1,
                    .low = none,
                    .bends = true};
    all[kept] = {"kept", "pu", "limit of Ipcmd in the last dip", 0.1};
    return all;
  }();

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    renewable::check_electrical<Model>(values);
    values.require_switches({PFLAG});
    values.require_times({Thld2});
  }
  static std::string remark(const double* p) { return Core::remote(p[RemoteBus]); }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    Core::prepare(renewable::electrical_values<Model>(p), c);
    renewable::prepare_by_voltage(p + Vq1, p[Imax], c + of_q);
    renewable::prepare_by_voltage(p + Vp1, p[Imax], c + of_p);
    c[turns] = p[PFLAG];
    const T zero(0.0);
    c[frozen] = select(p[Thld] > zero, p[Iqfrz], zero);
    c[goes_on] = select(p[Thld] < zero, T(1.0), zero);
    c[hold] = select(p[Thld] < zero, zero - p[Thld], p[Thld]);
    c[hold_p] = p[Thld2];
    c[follows] = select(p[Thld2] > zero, T(1.0 / renewable::kFollow), zero);
    c[none] = zero;
  }
  template <class T>
  static void publish(const T*, const T* x, Signals<T>& s) {
    s.Pord = x[Core::Pord];
  }
  template <class T>
  static T turning(const T* c, const Signals<T>& s) {
    return T(1.0) + c[turns] * s.wg;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T one(1.0), Vf = Core::measure(c, x, s, dx);
    const T dip = renewable::voltage_dip(s.V, c[Core::vdip], c[Core::vup]);
    const T later = renewable::timer(dip, c[hold], x[after], dx[after]);
    const T rides = Core::ride_through(c, Vf);
    const T injected = dip * rides + later * (c[frozen] + c[goes_on] * rides);
    const T stays = renewable::timer(dip, c[hold_p], x[after_p], dx[after_p]);
    const auto active_limit = [&](const T& left) {
      dx[kept] = (one - stays) * (left - x[kept]) * c[follows];
      return left + stays * (x[kept] - left);
    };
    Core::commands(
        c, x, Vf, Vf, one - dip, (c[Core::pneed] + s.Pext) * turning(c, s),
        {renewable::by_voltage(c + of_p, Vf), T(0.0), renewable::by_voltage(c + of_q, Vf)},
        [&](const T& Iq) { return Iq + injected; }, renewable::as_it_is, active_limit, s, dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    Core::reference(c, s);
    if (value_of(renewable::voltage_dip(s.V, c[Core::vdip], c[Core::vup])) > 0.0)
      return fmt::format("the dip logic acts at V = {:.4f} pu: Vdip = {:g}, Vup = {:g} pu", value_of(s.V),
                         value_of(c[Core::vdip]), value_of(c[Core::vup]));
    const T most_p = renewable::by_voltage(c + of_p, s.V), most_q = renewable::by_voltage(c + of_q, s.V);
    x[after] = x[after_p] = T(0.0);
    const T left = renewable::smaller(most_p, renewable::other_current(c[Core::imax], s.Efd));
    x[kept] = select(c[Core::active_first] > T(0.5), most_p, left);
    return Core::steady(c, s.V, T(0.0), p[Vbias], turning(c, s), {most_p, T(0.0), most_q}, s, x);
  }
};

}  // namespace swingbank::sim::effects::electrical_control_reeca1
