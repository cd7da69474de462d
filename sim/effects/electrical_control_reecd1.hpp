#pragma once
// REECD1: electrical control of a wind, photovoltaic or battery plant, with a compensated voltage and
// blocking.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/electrical_records.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::electrical_control_reecd1 {

struct Model : renewable::RideThrough<6>, renewable::Regulators<18>, renewable::Orders<28> {
  static constexpr std::string_view
      name = "REECD1",
      title = "electrical control of a wind, photovoltaic or battery plant, type D",
      source =
          "WECC, REEC_D, as in InterPSS (Reecd1Model, github.com/InterPSS-Project/ipss-plugin, 71de79e: equations, "
          "columns) and Dynawo (REECd); PSS/E REECD1, REECDU1",
      dyr_name = "REECD1";
  static constexpr Slot slot = Slot::electrical_control;
  static constexpr std::string_view variant_of = "REECA1";
  static constexpr std::string_view description = R"(
  Vf = V/(1 + s Trv)    dip: Vf < Vdip or Vf > Vup freezes the integrals, Iq and Pord
  Vc = |V - (Rc + jXc) I| (VCMPFLAG 1), V + Kc Q (VCMPFLAG 0), behind 1/(1 + s Tr1)
  Qin = Qext (PFFLAG 0), tan(phi0) P/(1 + s Tp) (PFFLAG 1)
  Qin within Qmin, Qmax - Q --> [ Kqp + Kqi/s, Vmin to Vmax ] --> Vcmd (VFLAG 1);  Qin + Vref1 --> Vcmd (VFLAG 0)
  Vcmd within Vmin, Vmax - Vc --> [ Kvp + Kvi/s, Iqmin to Iqmax ] --> Iq (QFLAG 1)
  Qin/Vf --> [ 1/(1 + s Tiq) ] --> Iq (QFLAG 0)
  Vref0 - Vf --> [ dbd1, dbd2 ] --> x Kqv within Iql1, Iqh1 --> Iqv       Iqcmd = Iq + Iqv; for |Thld| after a dip
      its value at the dip's end (Thld > 0) or Iqfrz (Thld < 0)
  Pext (x (1 + wg) if PFLAG = 1) --> [ 1/(1 + s Tpord), rate dPmin to dPmax, Pmin to Pmax ] --Pord--> /Vf --> Ipcmd;
      for Thld2 after a dip Ipcmd and its limit keep their values at the dip's end
  Iqcmd within VDL1(Vf), Ipcmd within VDL2(Vf): linear between the points (Vq, Iq) and (Vp, Ip), up to the last
      rising voltage; all 0: no limit. Ipcmd >= -Ke times its upper limit.
  |Ipcmd + j Iqcmd| <= Imax; reduced first: Ipcmd (PQFLAG 0), Iqcmd (PQFLAG 1); Iqmin, Iqmax: limits of Iqcmd
  Both currents are blocked while Vf < Vblkl or Vf > Vblkh, and for Tblk afterwards.
  Vref0 = 0: the voltage at the operating point. The regulated terminal is the unit's own.
)";
  static constexpr int kTablePoints = 10;
  enum P {
    PFFLAG,
    VFLAG,
    QFLAG,
    PFLAG,
    PQFLAG,
    VCMPFLAG,
    Iqfrz = Vref0 + 1,
    Thld,
    Thld2,
    Vref1 = Kvi + 1,
    Vq1 = Tpord + 1,
    Vp1 = Vq1 + 2 * kTablePoints,
    Rc = Vp1 + 2 * kTablePoints,
    Xc,
    Tr1,
    Kc,
    Ke,
    Vblkl,
    Vblkh,
    Tblk,
    parameter_count
  };
  static_assert(VCMPFLAG + 1 == Vdip && Thld2 + 1 == Tp && Vref1 + 1 == Tiq);
  static constexpr Source defaults_from = literature::psid("FourBus_multigen.dyr");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Source kOff = literature::own("off, as in REECA1");
  static constexpr std::array kCodes = {
      renewable::record::PFFLAG,
      renewable::record::VFLAG,
      renewable::record::QFLAG,
      renewable::record::PFLAG,
      renewable::record::PQFLAG,
      Parameter{"VCMPFLAG", "VCMPFLAG", "code", 1.0, 0.0, 1.0, kNoNullValue,
                "regulated voltage: 1 behind Rc + jXc, 0 V + Kc Q", kOff, renewable::kFlag}};
  static constexpr std::array kAfterDip = {
      Parameter{"Iqfrz", "Iqfrz", "pu", 0.0, -2.0, 2.0, 0.0, "Iqcmd for |Thld| after a dip if Thld < 0"},
      Parameter{"Thld", "Thld", "s", 0.0, -10.0, 10.0, 0.0,
                "time after a dip for which Iqcmd is kept (> 0) or Iqfrz (< 0)"},
      Parameter{"Thld2", "Thld2", "s", 0.0, 0.0, 10.0, 0.0,
                "time after a dip for which Ipcmd and its limit are kept"}};
  static constexpr std::array kBias = {
      Parameter{"Vref1", "Vref1", "pu", 0.0, -2.0, 2.0, kNoNullValue, "added to a Qext that is a voltage"}};
  static constexpr std::array kBehind = {
      Parameter{"Rc", "Rc", "pu", 0.0, -1.0, 1.0, 0.0, "compensating resistance", kOff},
      Parameter{"Xc", "Xc", "pu", 0.0, -1.0, 1.0, 0.0, "compensating reactance", kOff},
      Parameter{"Tr1", "Tr1", "s", 0.02, 0.0, 10.0, kNoNullValue, "lag of the regulated voltage (0: none)",
                literature::own("as Trv")},
      Parameter{"Kc", "Kc", "pu", 0.0, 0.0, 1.0, 0.0, "reactive droop", kOff},
      Parameter{"Ke", "Ke", "pu", 0.0, 0.0, 1.0, 0.0,
                "Ipcmd is at least -Ke times its upper limit (battery: 1)", kOff,
                literature::derived("a fraction")},
      Parameter{"Vblkl", "Vblkl", "pu", 0.0, -99.0, 1.0, kNoNullValue,
                "voltage below which the converter is blocked", kOff},
      Parameter{"Vblkh", "Vblkh", "pu", 99.0, 0.8, 99.0, kNoNullValue, "voltage above which it is blocked",
                kOff},
      Parameter{"Tblk", "Tblk", "s", 0.0, 0.0, 10.0, 0.0,
                "time for which the converter stays blocked afterwards", kOff}};
  static constexpr auto parameters =
      renewable::joined(kCodes, ride_through, kAfterDip, regulators, kBias, orders,
                        renewable::limit_points<kTablePoints>(1.11, 1.11), kBehind);
  static constexpr auto dyr_columns = shared::columns_to<parameter_count - 1>();
  using Core = renewable::ElectricalControl;
  enum C {
    of_q = Core::coefficients,
    of_p = of_q + renewable::kByVoltage<kTablePoints>,
    turns = of_p + renewable::kByVoltage<kTablePoints>,  ///< PFLAG
    behind,                                              ///< VCMPFLAG
    rc,
    xc,
    kc,
    iTr1,
    ke,
    vblkl,
    vblkh,
    tblk,
    frozen,  ///< Iqfrz if Thld < 0
    keeps,   ///< 1 if Thld > 0
    hold,    ///< |Thld|
    hold_p,
    follows_q,  ///< 1/kFollow, 0 if no value is to be kept
    follows_p,
    none,
    coefficients
  };
  enum X { Vcomp = Core::count, after, after_p, blocked, kept_q, kept_p, kept_most, count };
  static constexpr auto states = [] {
    std::array<State, count> all{};
    std::copy(Core::states.begin(), Core::states.end(), all.begin());
    all[Vcomp] = {"Vcomp", "pu", "measured regulated voltage"};
    constexpr auto left = [](std::string_view name, std::string_view meaning) {
      return State{.name = name, .unit = "s", .meaning = meaning, .low = none, .bends = true};
    };
    all[after] = left("after", "remaining time of Thld");
    all[after_p] = left("after_p", "remaining time of Thld2");
    all[blocked] = left("blocked", "remaining time of Tblk");
    all[kept_q] = {"kept_q", "pu", "Iqcmd in the last dip"};
    all[kept_p] = {"kept_p", "pu", "Ipcmd in the last dip"};
    all[kept_most] = {"kept_most", "pu", "limit of Ipcmd in the last dip"};
    return all;
  }();

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    renewable::check_electrical<Model>(values);
    values.require_switches({PFLAG, VCMPFLAG});
    values.require_times({Thld2, Tr1, Tblk});
    values.require_ranges({{Vblkh, Vblkl}});
    for (int i = Vq1 + 1; i < Rc; i += 2) values.refuse_negative({i});
    values.refuse(!(p[Ke] >= 0 && p[Ke] <= 1), Ke, "it is a fraction of the upper limit", "give 0 to 1");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    Core::prepare(renewable::electrical_values<Model>(p), c);
    renewable::prepare_by_voltage<kTablePoints>(p + Vq1, p[Imax], c + of_q);
    renewable::prepare_by_voltage<kTablePoints>(p + Vp1, p[Imax], c + of_p);
    for (const auto& [to, from] : {std::pair<int, int>{turns, PFLAG},
                                   {behind, VCMPFLAG},
                                   {rc, Rc},
                                   {xc, Xc},
                                   {kc, Kc},
                                   {ke, Ke},
                                   {vblkl, Vblkl},
                                   {vblkh, Vblkh},
                                   {tblk, Tblk},
                                   {hold_p, Thld2}})
      c[to] = p[from];
    const T zero(0.0), one(1.0), follow(1.0 / renewable::kFollow);
    c[iTr1] = inverse(p[Tr1]);
    c[frozen] = select(p[Thld] < zero, p[Iqfrz], zero);
    c[keeps] = select(p[Thld] > zero, one, zero);
    c[hold] = select(p[Thld] < zero, zero - p[Thld], p[Thld]);
    c[follows_q] = select(p[Thld] > zero, follow, zero);
    c[follows_p] = select(p[Thld2] > zero, follow, zero);
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
  /// Returns the regulated voltage before its measurement [pu].
  template <class T>
  static T compensated(const T* c, const Signals<T>& s) {
    using std::sqrt;
    const T re = s.Vr - c[rc] * s.Ir + c[xc] * s.Ii, im = s.Vi - c[rc] * s.Ii - c[xc] * s.Ir, tiny(1e-12);
    const T square_2 = re * re + im * im;
    return select(c[behind] > T(0.5), sqrt(select(square_2 > tiny, square_2, tiny)), s.V + c[kc] * s.Q);
  }
  template <class T>
  static Core::Limits<T> limits(const T* c, const T& V, const T& live) {
    const T most_p = live * renewable::by_voltage<kTablePoints>(c + of_p, V);
    return {most_p, T(0.0) - c[ke] * most_p, live * renewable::by_voltage<kTablePoints>(c + of_q, V)};
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T one(1.0), Vf = Core::measure(c, x, s, dx);
    const T dip = renewable::voltage_dip(Vf, c[Core::vdip], c[Core::vup]);
    const T off = renewable::voltage_dip(Vf, c[vblkl], c[vblkh]);
    const T live = one - off - renewable::timer(off, c[tblk], x[blocked], dx[blocked]);
    const T later = renewable::timer(dip, c[hold], x[after], dx[after]);
    const T stays = renewable::timer(dip, c[hold_p], x[after_p], dx[after_p]);
    const T Vc = lag(c[iTr1], x[Vcomp], compensated(c, s), dx[Vcomp]);
    const T rides = Core::ride_through(c, Vf);
    const auto total = [&](const T& Iq) {
      const T now = Iq + rides;
      dx[kept_q] = (one - later) * (now - x[kept_q]) * c[follows_q];
      return now + later * (c[frozen] + c[keeps] * x[kept_q] - now);
    };
    const auto active = [&](const T& asked) { return asked + stays * (x[kept_p] - asked); };
    const auto active_limit = [&](const T& left) {
      dx[kept_most] = (one - stays) * (left - x[kept_most]) * c[follows_p];
      return left + stays * live * (x[kept_most] - left);
    };
    Core::commands(c, x, Vf, Vc, one - dip, (c[Core::pneed] + s.Pext) * turning(c, s), limits(c, Vf, live),
                   total, active, active_limit, s, dx);
    dx[kept_p] = (one - stays) * (s.Tm - x[kept_p]) * c[follows_p];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    Core::reference(c, s);
    const auto within = [&](const char* what, int low, int high) {
      return value_of(renewable::voltage_dip(s.V, c[low], c[high])) > 0.0
                 ? fmt::format("V = {:.4f} pu {}: the limits are {:g} and {:g} pu", value_of(s.V), what,
                               value_of(c[low]), value_of(c[high]))
                 : std::string();
    };
    if (auto why = within("activates the dip logic", Core::vdip, Core::vup); !why.empty()) return why;
    if (auto why = within("blocks the converter", vblkl, vblkh); !why.empty()) return why;
    x[after] = x[after_p] = x[blocked] = T(0.0);
    x[Vcomp] = compensated(c, s);
    x[kept_q] = s.Efd;
    x[kept_p] = s.Tm;
    const auto most = limits(c, s.V, T(1.0));
    const T beside = renewable::other_current(c[Core::imax], s.Efd);
    x[kept_most] =
        renewable::smaller(most.most_p, select(c[Core::active_first] > T(0.5), c[Core::imax], beside));
    return Core::steady(c, x[Vcomp], Core::ride_through(c, s.V), p[Vref1], turning(c, s), most, s, x);
  }
};

}  // namespace swingbank::sim::effects::electrical_control_reecd1
