#pragma once
// REPCA1: plant controller of a wind, photovoltaic or storage plant.

#include "sim/core/effect.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/renewable.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::plant_control_repca1 {

struct Model {
  static constexpr std::string_view name = "REPCA1", title = "control of a renewable energy plant, type A",
                                    source =
                                        "WECC (2014), Wind plant dynamic modeling guidelines, REPC_A; "
                                        "PSS/E REPCA1",
                                    dyr_name = "REPCA1";
  static constexpr Slot slot = Slot::plant_control;
  static constexpr std::string_view description = R"(
  measured = |V - (Rc + j Xc) I| (RefFlag 1, VCFlag 1), V + Kc Q (RefFlag 1, VCFlag 0), Q (RefFlag 0)
  ref - measured/(1 + s Tfltr) --> [ dbd1, dbd2 ] --> within emin, emax -->
      [ Kp + Ki/s, Qmin to Qmax, frozen while V < Vfrz ] --> [ (1 + s Tft)/(1 + s Tfv) ] --> Qext
  - speed --> [ fdbd1, fdbd2 ] --> x Ddn where it is negative, x Dup where it is positive --droop
  Pref - P/(1 + s Tp) + droop --> within femin, femax --> [ Kpg + Kig/s, Pmin to Pmax ] --> [ 1/(1 + s Tg) ] --> Pext
      (FrqFlag 1; 0: Pext is constant)
  V is that of the remote bus, I, P and Q are those of the branch, from its first bus to its second, on the unit's
  base; 0: those of the unit's own terminal. In a plant file, which has no other bus, they are those of the recorded
  point. Changes of the references of V (or Q) and P are added to ref and Pref.
)";
  enum P {
    RemoteBus,
    FromBus,
    ToBus,
    Circuit,
    VCFlag,
    RefFlag,
    FrqFlag,
    Tfltr,
    Kp,
    Ki,
    Tft,
    Tfv,
    Vfrz,
    Rc,
    Xc,
    Kc,
    emax,
    emin,
    dbd1,
    dbd2,
    Qmax,
    Qmin,
    Kpg,
    Kig,
    Tp,
    fdbd1,
    fdbd2,
    femax,
    femin,
    Pmax,
    Pmin,
    Tg,
    Ddn,
    Dup
  };
  static constexpr Source defaults_from = literature::psid("FourBus_multigen.dyr");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Parameter parameters[] = {
      {"RemoteBus", "remote bus", "code", 0.0, 0.0, 999997.0, 0.0, "regulated bus (0: the terminal)",
       kAsEffect, renewable::kBus},
      {"FromBus", "from bus", "code", 0.0, 0.0, 999997.0, 0.0,
       "first bus of the measured branch (0: the unit)", kAsEffect, renewable::kBus},
      {"ToBus", "to bus", "code", 0.0, 0.0, 999997.0, 0.0, "second bus of that branch", kAsEffect,
       renewable::kBus},
      {"Circuit", "circuit", "code", 0.0, 0.0, 99.0, 0.0, "circuit of that branch", kAsEffect,
       renewable::kBus},
      {"VCFlag", "VCFlag", "code", 0.0, 0.0, 1.0, kNoNullValue, "1: line drop, 0: reactive droop", kAsEffect,
       renewable::kFlag},
      {"RefFlag", "RefFlag", "code", 0.0, 0.0, 1.0, kNoNullValue, "1: regulates V, 0: Q", kAsEffect,
       renewable::kFlag},
      {"FrqFlag", "FrqFlag", "code", 1.0, 0.0, 1.0, kNoNullValue, "1: regulates P, 0: constant Pext",
       kAsEffect, renewable::kFlag},
      {"Tfltr", "Tfltr", "s", 0.02, 0.0, 10.0, kNoNullValue, "lag of the measurement of V or Q (0: none)"},
      {"Kp", "Kp", "pu/pu", 18.0, 0.0, 200.0, 0.0, "proportional gain"},
      {"Ki", "Ki", "1/s", 5.0, 0.0, 200.0, 0.0, "integral gain"},
      {"Tft", "Tft", "s", 0.0, 0.0, 10.0, 0.0, "lead of Qext"},
      {"Tfv", "Tfv", "s", 0.05, 0.0, 30.0, kNoNullValue, "lag of Qext (0: none)"},
      {"Vfrz", "Vfrz", "pu", 0.0, -99.0, 1.2, kNoNullValue, "voltage below which the integral is frozen"},
      {"Rc", "Rc", "pu", 0.0, -1.0, 1.0, 0.0, "line drop, resistance"},
      {"Xc", "Xc", "pu", 0.0, -1.0, 1.0, 0.0, "line drop, reactance"},
      {"Kc", "Kc", "pu/pu", 0.02, 0.0, 1.0, 0.0, "reactive droop"},
      upper_limit({"emax", "emax", "pu", 0.1, 0.0, 999.0, kNoNullValue, "highest error"}),
      lower_limit({"emin", "emin", "pu", -0.1, -999.0, 0.0, kNoNullValue, "lowest error"}),
      {"dbd1", "dbd1", "pu", 0.0, -1.0, 0.0, 0.0, "lower edge of the dead-band", literature::psse("REPCA1")},
      {"dbd2", "dbd2", "pu", 0.0, 0.0, 1.0, 0.0, "upper edge of the dead-band", literature::psse("REPCA1")},
      upper_limit({"Qmax", "Qmax", "pu", 0.43, -1.0, 999.0, kNoNullValue, "highest Qext"}),
      lower_limit({"Qmin", "Qmin", "pu", -0.43, -999.0, 1.0, kNoNullValue, "lowest Qext"}),
      {"Kpg", "Kpg", "pu/pu", 1.0, 0.0, 100.0, 0.0, "regulator of P, proportional gain"},
      {"Kig", "Kig", "1/s", 0.05, 0.0, 100.0, 0.0, "regulator of P, integral gain"},
      {"Tp", "Tp", "s", 0.25, 0.0, 10.0, kNoNullValue, "lag of the measurement of P (0: none)"},
      {"fdbd1", "fdbd1", "pu", -0.0006, -1.0, 0.0, 0.0, "lower edge of the frequency's dead-band",
       literature::own("0.036 Hz of 60 Hz, NERC's guideline on primary frequency control")},
      {"fdbd2", "fdbd2", "pu", 0.0006, 0.0, 1.0, 0.0, "upper edge of the frequency's dead-band",
       literature::own("0.036 Hz of 60 Hz, NERC's guideline on primary frequency control")},
      upper_limit({"femax", "femax", "pu", 99.0, 0.0, 999.0, kNoNullValue, "upper limit of the error of P"}),
      lower_limit(
          {"femin", "femin", "pu", -99.0, -999.0, 0.0, kNoNullValue, "lower limit of the error of P"}),
      upper_limit({"Pmax", "Pmax", "pu", 1.0, 0.0, 999.0, kNoNullValue, "highest Pext"}),
      lower_limit({"Pmin", "Pmin", "pu", 0.0, -999.0, 1.0, kNoNullValue, "lowest Pext"}),
      {"Tg", "Tg", "s", 0.1, 0.0, 30.0, kNoNullValue, "lag of Pext (0: none)"},
      {"Ddn", "Ddn", "pu/pu", 0.0, 0.0, 200.0, 0.0, "power per frequency above the reference"},
      {"Dup", "Dup", "pu/pu", 0.0, 0.0, 200.0, 0.0, "power per frequency below the reference"}};
  static constexpr auto dyr_columns = shared::columns_to<Dup>();
  static constexpr Elsewhere elsewhere = {.bus = RemoteBus, .from = FromBus, .to = ToBus, .circuit = Circuit};
  enum C {
    at_bus,  ///< flags: 1 or 0
    at_branch,
    by_voltage,
    line_drop,
    by_power,
    iTfltr,
    kp,
    ki,
    tft,
    iTfv,
    vfrz,
    rc,
    xc,
    kc,
    most,
    least,
    below,
    above,
    qmax,
    qmin,
    kpg,
    kig,
    iTp,
    f_below,
    f_above,
    p_most,
    p_least,
    pmax,
    pmin,
    iTg,
    ddn,
    dup,
    ref,
    pref,
    q0,
    p0,
    coefficients
  };
  enum X { measured, integral, lead, power, p_integral, p_lag };
  static constexpr State states[] = {
      {"measured", "pu", "measured voltage or reactive power"},
      {.name = "integral", .unit = "pu", .meaning = "integral of the regulator of V or Q", .bends = true},
      {"lead", "pu", "lag of Qext"},
      {"power", "pu", "measured active power"},
      {.name = "p_integral", .unit = "pu", .meaning = "integral of the regulator of P", .bends = true},
      {"p_lag", "pu", "lag of Pext"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_numbers({RemoteBus, FromBus, ToBus});
    values.require_switches({VCFlag, RefFlag, FrqFlag});
    values.require_times({Tfltr, Tft, Tfv, Tp, Tg});
    values.require_ranges({{emax, emin}, {Qmax, Qmin}, {femax, femin}, {Pmax, Pmin}});
    values.refuse_negative({dbd2, fdbd2, Kp, Ki, Kpg, Kig, Ddn, Dup});
    values.refuse_positive({dbd1, fdbd1});
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    for (const auto& [to, from] : {std::pair<int, int>{by_voltage, RefFlag},
                                   {line_drop, VCFlag},
                                   {by_power, FrqFlag},
                                   {kp, Kp},
                                   {ki, Ki},
                                   {tft, Tft},
                                   {vfrz, Vfrz},
                                   {rc, Rc},
                                   {xc, Xc},
                                   {kc, Kc},
                                   {most, emax},
                                   {least, emin},
                                   {below, dbd1},
                                   {above, dbd2},
                                   {qmax, Qmax},
                                   {qmin, Qmin},
                                   {kpg, Kpg},
                                   {f_below, fdbd1},
                                   {f_above, fdbd2},
                                   {p_most, femax},
                                   {p_least, femin},
                                   {pmax, Pmax},
                                   {pmin, Pmin},
                                   {ddn, Ddn},
                                   {dup, Dup}})
      c[to] = p[from];
    c[at_bus] = T(value_of(p[RemoteBus]) != 0.0 ? 1.0 : 0.0);
    c[at_branch] = T(value_of(p[FromBus]) != 0.0 || value_of(p[ToBus]) != 0.0 ? 1.0 : 0.0);
    c[kig] = value_of(p[FrqFlag]) > 0.5 ? p[Kig] : T(0.0);
    c[iTfltr] = inverse(p[Tfltr]);
    c[iTfv] = inverse(p[Tfv]);
    c[iTp] = inverse(p[Tp]);
    c[iTg] = inverse(p[Tg]);
  }
  /// Measured quantities, at the bus and branch that the parameters name, else at the terminal.
  template <class T>
  struct Measured {
    T Vr, Vi, V, Ir, Ii, P, Q;
  };
  template <class T>
  static Measured<T> measure_at(const T* c, const Signals<T>& s) {
    Measured<T> m{s.Vr, s.Vi, s.V, s.Ir, s.Ii, s.P, s.Q};
    const T half(0.5);
    const Far<T>& f = s.far;
    m.Vr = select(c[at_bus] > half, f.Vr, m.Vr);
    m.Vi = select(c[at_bus] > half, f.Vi, m.Vi);
    m.V = select(c[at_bus] > half, magnitude(f.Vr, f.Vi), m.V);
    m.Ir = select(c[at_branch] > half, f.Ir, m.Ir);
    m.Ii = select(c[at_branch] > half, f.Ii, m.Ii);
    m.P = select(c[at_branch] > half, f.P, m.P);
    m.Q = select(c[at_branch] > half, f.Q, m.Q);
    return m;
  }
  template <class T>
  static T regulated(const T* c, const Measured<T>& s) {
    const T half(0.5);
    const T re = s.Vr - c[rc] * s.Ir + c[xc] * s.Ii, im = s.Vi - c[rc] * s.Ii - c[xc] * s.Ir;
    const T dropped = magnitude(re, im);
    const T voltage = select(c[line_drop] > half, dropped, s.V + c[kc] * s.Q);
    return select(c[by_voltage] > half, voltage, s.Q);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T zero(0.0), one(1.0);
    const Measured<T> m = measure_at(c, s);
    const T at = lag(c[iTfltr], x[measured], regulated(c, m), dx[measured]);
    const T error = clamp(renewable::dead_zone(c[ref] + s.dVref - at, c[below], c[above]), c[least], c[most]);
    const T runs = one - clamp((c[vfrz] - m.V) * T(1.0 / renewable::kDipBand), zero, one);
    const T q = renewable::regulator(c[kp], c[ki], error, c[qmin], c[qmax], runs, x[integral], dx[integral]);
    s.Qext = lead_lag(c[tft], c[iTfv], x[lead], q, dx[lead]) - c[q0];

    const T deviation = renewable::dead_zone(zero - s.speed, c[f_below], c[f_above]);
    const T droop = c[dup] * positive_part(deviation) - c[ddn] * positive_part(zero - deviation);
    const T p = lag(c[iTp], x[power], m.P, dx[power]);
    const T p_error = clamp(c[pref] + s.dPref - p + droop, c[p_least], c[p_most]);
    const T asked =
        renewable::regulator(c[kpg], c[kig], p_error, c[pmin], c[pmax], one, x[p_integral], dx[p_integral]);
    const T followed = lag(c[iTg], x[p_lag], asked, dx[p_lag]);
    s.Pext = select(c[by_power] > T(0.5), followed - c[p0], s.Pext);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    const Measured<T> m = measure_at(c, s);
    x[measured] = c[ref] = regulated(c, m);
    x[integral] = x[lead] = c[q0] = s.Qneed;
    x[power] = c[pref] = m.P;
    x[p_integral] = x[p_lag] = c[p0] = s.Pneed;
    if (auto why = shared::outside("Qext", c[q0], c[qmin], c[qmax]); !why.empty()) return why;
    if (value_of(c[by_power]) > 0.5) return shared::outside("Pext", c[p0], c[pmin], c[pmax]);
    x[p_integral] = x[p_lag] = clamp(c[p0], c[pmin], c[pmax]);
    return {};
  }
};

}  // namespace swingbank::sim::effects::plant_control_repca1
