#pragma once
// DERA1: distributed generation or batteries, aggregated into one converter with its controls and with
// protection that trips a fraction of the units.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/controlled_current.hpp"
#include "sim/effects/detail/electrical_control.hpp"
#include "sim/effects/detail/lasting.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::converter_dera1 {

struct Model : shared::ControlledCurrent<Model> {
  static constexpr std::string_view
      name = "DERA1",
      title = "aggregated distributed generation, type A",
      source =
          "EPRI (2019), The new aggregated distributed energy resources (der_a) "
          "model, 3002015320, as in Dynawo (BaseDERa), InterPSS (DER_A_PosSeqImpl) and "
          "PowerSimulationsDynamics.jl; PSS/E DERA1 (columns: "
          "PowerSystemsTestData, 240_bus_remap2_dera2.dyr)",
      dyr_name = "DERA1";
  static constexpr std::string_view description = R"(
  Vf = V/(1 + s Trv)    Pf = Pord/(1 + s Tp)    f: frequency of the terminal, lagged by Trf
  Qref (pfFlag 0), tan(phi0) Pf (pfFlag 1) --> /Vf --> [ 1/(1 + s Tiq) ] --> Iq
  Vref0 + dVref - Vf --> [ dbd1, dbd2 ] --> x Kqv within Iql1, Iqh1 --> + Iq --> Iqcmd
  1 - f --> [ fdbd1, fdbd2 ] --> x Ddn below 0, x Dup above --> + Pref + dPref - Pf within femin, femax
      --> [ Kpg + Kig/s, Pmin to Pmax ] (freqFlag 1);  Pref + dPref (freqFlag 0)
      --> [ rate dPmin to dPmax ] --> [ 1/(1 + s Tpord), Pmin to Pmax ] --Pord--> /Vf --> Ipcmd
  |Ipcmd + j Iqcmd| <= Imax; reduced first: Ipcmd (pqFlag 0), Iqcmd (pqFlag 1)
  Ipcmd >= 0 (genFlag 1); down to minus its upper limit (genFlag 0: a battery)
  Ipcmd, Iqcmd x M --> [ 1/(1 + s Tg) ] --> Ip, Iq        Ip rises by rrpwr at most
  M = Mv Mf behind 1/(1 + s Tv)
  Mv (vtripFlag 1): 1 above Vl1, 0 below Vl0, linear between. After tvl1 below Vl1, only the fraction
      Vrfrac of the units tripped at the lowest Vf reconnects; after tvl0 below Vl0, none does. Vh1, Vh0, tvh1,
      tvh0 likewise.
  Mf (ftripFlag 1): 0 permanently after f was below fl for tfl or above fh for tfh while V > Vpr

  I = (Ip - j Iq) V/|V|, below |V| = 0.01 pu in proportion to |V|
  Near a bolted fault the grid cannot accept the whole of Ip at any voltage angle: |V| falls below 0.01 pu.
  Vref0 = 0: the voltage at the operating point.
  It takes no commands: no converter control may accompany it. Additions to Tm and Efd act on Ipcmd and
  Iqcmd.
)";
  static constexpr bool takes_commands = false;
  enum P {
    pfFlag,
    freqFlag,
    pqFlag,
    genFlag,
    vtripFlag,
    ftripFlag,
    Trv,
    Trf,
    dbd1,
    dbd2,
    Kqv,
    Vref0,
    Tp,
    Tiq,
    Ddn,
    Dup,
    fdbd1,
    fdbd2,
    femax,
    femin,
    Pmax,
    Pmin,
    dPmax,
    dPmin,
    Tpord,
    Kpg,
    Kig,
    Imax,
    Vl0,
    Vl1,
    Vh0,
    Vh1,
    tvl0,
    tvl1,
    tvh0,
    tvh1,
    Vrfrac,
    fl,
    fh,
    tfl,
    tfh,
    Tg,
    rrpwr,
    Tv,
    Vpr,
    Iqh1,
    Iql1,
    parameter_count
  };
  static constexpr Source defaults_from = literature::psid("DERA, in its test 42");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Source kActs = literature::own("narrower than the voltage changes at faults");
  static constexpr Source kTrips = literature::own("trip settings of category II in IEEE Std 1547-2018");
  static constexpr Source kHertz = literature::own("around 50 and 60 Hz; 0 and 999: never");
  static constexpr Parameter parameters[] = {
      {"pfFlag", "pfFlag", "code", 1.0, 0.0, 1.0, kNoNullValue, "1: constant power factor, 0: constant Q",
       kAsEffect, renewable::kFlag},
      {"freqFlag", "freqFlag", "code", 1.0, 0.0, 1.0, kNoNullValue, "1: active power depends on frequency",
       kAsEffect, renewable::kFlag},
      {"pqFlag", "pqFlag", "code", 0.0, 0.0, 1.0, kNoNullValue, "current priority at Imax: 0 Q, 1 P",
       kAsEffect, renewable::kFlag},
      {"genFlag", "genFlag", "code", 1.0, 0.0, 1.0, kNoNullValue, "1: generators, 0: batteries", kAsEffect,
       renewable::kFlag},
      {"vtripFlag", "vtripFlag", "code", 0.0, 0.0, 1.0, kNoNullValue,
       "1: voltage protection trips a fraction", shared::kNothing, renewable::kFlag},
      {"ftripFlag", "ftripFlag", "code", 0.0, 0.0, 1.0, kNoNullValue,
       "1: frequency protection trips all units", shared::kNothing, renewable::kFlag},
      {"Trv", "Trv", "s", 0.02, 0.0, 1.0, kNoNullValue, "lag of the voltage measurement (0: none)"},
      {"Trf", "Trf", "s", 0.02, 1e-3, 1.0, kNoNullValue, "lag of the frequency measurement"},
      {"dbd1", "dbd1", "pu", -0.05, -99.0, 0.0, 0.0, "lower edge of the voltage's dead-band", kActs},
      {"dbd2", "dbd2", "pu", 0.05, 0.0, 99.0, 0.0, "upper edge of the voltage's dead-band", kActs},
      {"Kqv", "Kqv", "pu/pu", 5.0, 0.0, 100.0, 0.0, "reactive current per voltage error"},
      {"Vref0", "Vref0", "pu", 0.0, 0.0, 1.5, kNoNullValue, "voltage reference (0: initial voltage)"},
      {"Tp", "Tp", "s", 0.02, 0.0, 10.0, kNoNullValue, "lag of the ordered-power measurement (0: none)"},
      {"Tiq", "Tiq", "s", 0.02, 0.0, 10.0, kNoNullValue, "lag of the reactive current (0: none)"},
      {"Ddn", "Ddn", "pu/pu", 20.0, 0.0, 200.0, 0.0, "power per frequency above the dead-band"},
      {"Dup", "Dup", "pu/pu", 0.0, 0.0, 200.0, 0.0, "power per frequency below the dead-band"},
      {"fdbd1", "fdbd1", "pu", -0.0006, -1.0, 0.0, 0.0, "lower edge of the frequency's dead-band"},
      {"fdbd2", "fdbd2", "pu", 0.0006, 0.0, 1.0, 0.0, "upper edge of the frequency's dead-band"},
      upper_limit({"femax", "femax", "pu", 99.0, 0.0, 99.0, kNoNullValue,
                   "upper limit of the power regulator's error"}),
      lower_limit({"femin", "femin", "pu", -99.0, -99.0, 0.0, kNoNullValue,
                   "lower limit of the power regulator's error"}),
      upper_limit({"Pmax", "Pmax", "pu", 1.1, 0.0, 99.0, kNoNullValue, "highest Pord"}),
      lower_limit({"Pmin", "Pmin", "pu", 0.0, -99.0, 1.0, kNoNullValue, "lowest Pord"}),
      {"dPmax", "dPmax", "pu/s", 0.5, 0.0, 999.0, kNoNullValue, "fastest rise of the power reference"},
      {"dPmin", "dPmin", "pu/s", -0.5, -999.0, 0.0, kNoNullValue, "fastest fall of the power reference"},
      {"Tpord", "Tpord", "s", 0.02, 0.0, 99.0, kNoNullValue, "lag of Pord (0: none)"},
      {"Kpg", "Kpg", "pu/pu", 0.1, 0.0, 100.0, 0.0, "power regulator, proportional gain"},
      {"Kig", "Kig", "1/s", 10.0, 0.0, 500.0, 0.0, "power regulator, integral gain"},
      upper_limit({"Imax", "Imax", "pu", 1.2, 0.1, 99.0, kNoNullValue, "largest current"}),
      {"Vl0", "Vl0", "pu", 0.44, 0.0, 1.0, kNoNullValue, "voltage below which all units trip"},
      {"Vl1", "Vl1", "pu", 0.49, 0.0, 1.0, kNoNullValue, "voltage below which units begin to trip"},
      {"Vh0", "Vh0", "pu", 1.2, 0.5, 99.0, kNoNullValue, "voltage above which all units trip"},
      {"Vh1", "Vh1", "pu", 1.15, 0.5, 99.0, kNoNullValue, "voltage above which units begin to trip"},
      {"tvl0", "tvl0", "s", 0.16, 0.0, 999.0, kNoNullValue, "time below Vl0 until no unit reconnects"},
      {"tvl1", "tvl1", "s", 0.16, 0.0, 999.0, kNoNullValue, "time below Vl1 until tripped units stay off"},
      {"tvh0", "tvh0", "s", 0.16, 0.0, 999.0, kNoNullValue, "time above Vh0 until no unit reconnects"},
      {"tvh1", "tvh1", "s", 0.16, 0.0, 999.0, kNoNullValue, "time above Vh1 until tripped units stay off"},
      {"Vrfrac", "Vrfrac", "-", 0.7, 0.0, 1.0, 1.0,
       "fraction of the tripped units that reconnects as V recovers", kAsEffect, shared::kShare},
      {"fl", "fl", "Hz", 56.5, 0.0, 60.0, kNoNullValue, "frequency below which all units trip", kTrips,
       kHertz},
      {"fh", "fh", "Hz", 62.0, 50.0, 999.0, kNoNullValue, "frequency above which all units trip", kTrips,
       kHertz},
      {"tfl", "tfl", "s", 0.16, 0.0, 999.0, kNoNullValue, "time below fl until all units trip", kTrips},
      {"tfh", "tfh", "s", 0.16, 0.0, 999.0, kNoNullValue, "time above fh until all units trip", kTrips},
      {"Tg", "Tg", "s", 0.02, 1e-3, 0.5, kNoNullValue, "time constant of the converters"},
      {"rrpwr", "rrpwr", "pu/s", 99.0, 0.01, 999.0, kNoNullValue, "fastest rise of the active current"},
      {"Tv", "Tv", "s", 0.02, 0.0, 1.0, kNoNullValue, "lag of the tripped fraction (0: none)"},
      {"Vpr", "Vpr", "pu", 0.8, 0.0, 1.0, kNoNullValue, "voltage below which frequency does not trip"},
      upper_limit({"Iqh1", "Iqh1", "pu", 1.0, 0.0, 99.0, kNoNullValue,
                   "upper limit of the voltage control's current"}),
      lower_limit({"Iql1", "Iql1", "pu", -1.0, -99.0, 0.0, kNoNullValue,
                   "lower limit of the voltage control's current"})};
  static constexpr auto dyr_columns = shared::columns_to<parameter_count - 1>();
  static constexpr double kRateLag = 0.01;        ///< time constant of the reference's rate limiter [s]
  static constexpr double kFrequencyBand = 1e-5;  ///< width beyond fl and fh over which a trip sets in [pu]
  /// The first coefficients are the parameters themselves. Vref0 = 0 is replaced by the initial voltage.
  enum C {
    iTrv = parameter_count,
    iTfreq,
    iTp,
    iTiq,
    iTpord,
    iTg,
    iTv,
    per_angle,
    kig,       ///< Kig if freqFlag = 1
    per_low,   ///< 1/(Vl1 - Vl0)
    per_high,  ///< 1/(Vh0 - Vh1)
    f_under,   ///< frequency deviations that cause a trip [pu]
    f_over,
    none,
    pref,
    qref,     ///< reactive power reference for pfFlag = 0
    tangent,  ///< tangent of the power factor angle
    start_p,  ///< both commands at the operating point
    start_q,
    coefficients
  };
  enum X {
    Vf,
    Pf,
    Iqlag,
    PI,
    Pset,
    Pord,
    M,
    Ip,
    Iq,
    low1,
    low0,
    least,
    high1,
    high0,
    most,
    under,
    over,
    Vrlag,
    Vilag
  };
  static constexpr auto states = [] {
    constexpr auto timer = [](std::string_view symbol, std::string_view meaning) {
      return State{.name = symbol, .unit = "s", .meaning = meaning, .low = none, .bends = true};
    };
    constexpr auto kinked = [](std::string_view symbol, std::string_view meaning) {
      return State{.name = symbol, .unit = "pu", .meaning = meaning, .bends = true};
    };
    return std::array{State{"Vf", "pu", "measured voltage"},
                      State{"Pf", "pu", "measured ordered power"},
                      State{"Iqlag", "pu", "lagged reactive current"},
                      kinked("PI", "integral of the power regulator"),
                      kinked("Pset", "rate-limited power reference"),
                      State{"Pord", "pu", "ordered power", 1.0, Pmin, Pmax},
                      State{"M", "-", "connected fraction"},
                      State{"Ip", "pu", "active current"},
                      State{"Iq", "pu", "reactive current"},
                      timer("low1", "time below Vl1"),
                      timer("low0", "time below Vl0"),
                      kinked("least", "lowest voltage since units stay off"),
                      timer("high1", "time above Vh1"),
                      timer("high0", "time above Vh0"),
                      kinked("most", "highest voltage since units stay off"),
                      timer("under", "time below fl"),
                      timer("over", "time above fh"),
                      kVrlag,
                      kVilag};
  }();
  enum S { voltage, scratch };

  static void check(const double* p, const std::string& where, Problems& problems);
  static std::string_view unphysical(const double* p) {
    return p[vtripFlag] == 1 && !(p[Vl0] < p[Vl1] && p[Vl1] < p[Vh1] && p[Vh1] < p[Vh0])
               ? "Vl0 < Vl1 < Vh1 < Vh0"
               : "";
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    const T one(1.0), per_hertz(1.0 / conventions.frequency);
    std::copy(p, p + parameter_count, c);
    for (const auto& [to, from] :
         {std::pair<int, int>{iTrv, Trv}, {iTp, Tp}, {iTiq, Tiq}, {iTpord, Tpord}, {iTg, Tg}, {iTv, Tv}})
      c[to] = inverse(p[from]);
    prepare_frequency(p[Trf], conventions, c);
    c[kig] = p[freqFlag] * p[Kig];
    c[per_low] = inverse(p[Vl1] - p[Vl0]);
    c[per_high] = inverse(p[Vh0] - p[Vh1]);
    c[f_under] = p[fl] * per_hertz - one;
    c[f_over] = p[fh] * per_hertz - one;
    c[none] = T(0.0);
  }
  template <class T>
  static void current(const T*, const T* x, T*, Signals<T>& s) {
    const T per = T(1.0) / renewable::at_least_small(magnitude(s.Vr, s.Vi));
    s.Ir = (x[Ip] * s.Vr + x[Iq] * s.Vi) * per;
    s.Ii = (x[Ip] * s.Vi - x[Iq] * s.Vr) * per;
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    m[voltage] = magnitude(s.Vr, s.Vi);
    terminal(c, x, squared_magnitude(s.Vr, s.Vi), s);
    s.Pord = x[Pord];
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    const T zero(0.0), V = lag(c[iTrv], x[Vf], m[voltage], dx[Vf]);
    const T power = measured(c, x, dx[Pf]);
    const T asked_p = ordered(c, x, power, s, dx) / renewable::at_least_small(V);
    const T asked_q = reactive(c, x, power, V, s, dx);
    const auto p_leads = c[pqFlag] > T(0.5);
    const T leading_p = clamp(asked_p, zero - (T(1.0) - c[genFlag]) * c[Imax], c[Imax]);
    const T most_q = select(p_leads, renewable::other_current(c[Imax], leading_p), c[Imax]);
    const T q = clamp(asked_q, zero - most_q, most_q);
    const T most_p = select(p_leads, c[Imax], renewable::other_current(c[Imax], q));
    const T p = clamp(asked_p, zero - (T(1.0) - c[genFlag]) * most_p, most_p);
    const T on = lag(c[iTv], x[M], stays_on(c, x, V, m[voltage], s.speed, dx), dx[M]);
    const T wanted = (on * (p + s.Tm - c[start_p]) - x[Ip]) * c[iTg], unlimited(renewable::kNoLimit);
    const auto draws = x[Ip] < zero;
    dx[Ip] =
        clamp(wanted, select(draws, zero - c[rrpwr], zero - unlimited), select(draws, unlimited, c[rrpwr]));
    dx[Iq] = (on * (q + s.Efd - c[start_q]) - x[Iq]) * c[iTg];
    follow_voltage(c, x, s, dx);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x);

 private:
  /// Returns the ordered power after the measurement lag Tp, which is the input of the power regulator and of
  /// the power factor control [pu].
  template <class T>
  static T measured(const T* c, const T* x, T& dx) {
    return lag(c[iTp], x[Pf], select(c[iTpord] > T(0.0), x[Pord], clamp(x[Pset], c[Pmin], c[Pmax])), dx);
  }
  template <class T>
  static T ordered(const T* c, const T* x, const T& back, const Signals<T>& s, T* dx) {
    const T zero(0.0), reference = c[pref] + s.dPref + s.dGref;
    const T off = renewable::dead_zone(zero - s.speed, c[fdbd1], c[fdbd2]);
    const T error = reference + c[Dup] * positive_part(off) - c[Ddn] * positive_part(zero - off) - back;
    const T regulated = renewable::regulator(c[Kpg], c[kig], clamp(error, c[femin], c[femax]), c[Pmin],
                                             c[Pmax], T(1.0), x[PI], dx[PI]);
    const T wanted = select(c[freqFlag] > T(0.5), regulated, reference);
    // A reference that moves slower than the rate limit passes unchanged.
    dx[Pset] = clamp((wanted - x[Pset]) * T(1.0 / kRateLag), c[dPmin], c[dPmax]);
    const T set = x[Pset] + T(kRateLag) * dx[Pset];
    dx[Pord] = (set - x[Pord]) * c[iTpord];
    return clamp(select(c[iTpord] > zero, x[Pord], set), c[Pmin], c[Pmax]);
  }
  template <class T>
  static T reactive(const T* c, const T* x, const T& power, const T& V, const Signals<T>& s, T* dx) {
    const T Q = select(c[pfFlag] > T(0.5), c[tangent] * power, c[qref]);
    return lag(c[iTiq], x[Iqlag], Q / renewable::at_least_small(V), dx[Iqlag]) + of_voltage(c, V, s.dVref);
  }
  template <class T>
  static T of_voltage(const T* c, const T& V, const T& moved) {
    return clamp(c[Kqv] * renewable::dead_zone(c[Vref0] + moved - V, c[dbd1], c[dbd2]), c[Iql1], c[Iqh1]);
  }
  /// Returns the fraction of units that neither voltage nor frequency has tripped. V: measured voltage,
  /// `at_once`: unfiltered voltage.
  template <class T>
  static T stays_on(const T* c, const T* x, const T& V, const T& at_once, const T& f, T* dx) {
    const T zero(0.0), one(1.0), per_band(1.0 / renewable::kDipBand), per_follow(1.0 / renewable::kFollow);
    const auto beyond = [&](const T& much) { return c[vtripFlag] * clamp(much * per_band, zero, one); };
    const T part_low = shared::passed(beyond(c[Vl1] - V), c[tvl1], x[low1], dx[low1]);
    const T all_low = shared::passed(beyond(c[Vl0] - V), c[tvl0], x[low0], dx[low0]);
    const T part_high = shared::passed(beyond(V - c[Vh1]), c[tvh1], x[high1], dx[high1]);
    const T all_high = shared::passed(beyond(V - c[Vh0]), c[tvh0], x[high0], dx[high0]);
    const T low = clamp(V, c[Vl0], c[Vl1]), high = clamp(V, c[Vh1], c[Vh0]);
    const T below = positive_part(x[least] - low), above = positive_part(high - x[most]);
    dx[least] = zero - part_low * below * per_follow;
    dx[most] = part_high * above * per_follow;
    const T left_low = (low - c[Vl0] - (one - c[Vrfrac]) * positive_part(low - x[least])) * c[per_low];
    const T left_high = (c[Vh0] - high - (one - c[Vrfrac]) * positive_part(x[most] - high)) * c[per_high];
    const T by_voltage = (one - all_low) * left_low * (one - all_high) * left_high;
    return (one - c[vtripFlag] * (one - by_voltage)) * by_frequency(c, x, at_once, f, dx);
  }
  template <class T>
  static T by_frequency(const T* c, const T* x, const T& V, const T& f, T* dx) {
    const T zero(0.0), one(1.0), per_band(1.0 / kFrequencyBand);
    const T counts = c[ftripFlag] * clamp((V - c[Vpr]) * T(1.0 / renewable::kDipBand), zero, one);
    const auto beyond = [&](const T& much) { return counts * clamp(much * per_band, zero, one); };
    return (one - shared::passed(beyond(c[f_under] - f), c[tfl], x[under], dx[under])) *
           (one - shared::passed(beyond(f - c[f_over]), c[tfh], x[over], dx[over]));
  }
};

template <class T>
std::string Model::steady(const T*, T* c, Signals<T>& s, T* x) {
  using std::sqrt;
  const T zero(0.0), V = sqrt(s.Vr * s.Vr + s.Vi * s.Vi);
  const T P = s.Vr * s.Ir + s.Vi * s.Ii, Q = s.Vi * s.Ir - s.Vr * s.Ii, p = P / V, q = Q / V;
  if (value_of(c[Vref0]) == 0.0) c[Vref0] = V;
  const double active = value_of(p), reactive = value_of(q), total = value_of(c[Imax]);
  if (active * active + reactive * reactive > total * total)
    return renewable::beyond_imax(active, reactive, total);
  if (active < 0 && value_of(c[genFlag]) == 1.0)
    return "it would draw power, and genFlag = 1 allows only generators";
  if (value_of(c[vtripFlag]) == 1.0 && (value_of(V) < value_of(c[Vl1]) || value_of(V) > value_of(c[Vh1])))
    return fmt::format("at V = {:.4f} pu a part of its units is tripped: Vl1 = {:g} pu, Vh1 = {:g} pu",
                       value_of(V), value_of(c[Vl1]), value_of(c[Vh1]));
  if (value_of(c[ftripFlag]) == 1.0 && (value_of(c[f_under]) > 0.0 || value_of(c[f_over]) < 0.0))
    return fmt::format(
        "its units trip at rated frequency: fl and fh differ from rated frequency by {:g} and {:g} pu",
        value_of(c[f_under]), value_of(c[f_over]));
  x[Vf] = V;
  x[Pf] = x[PI] = x[Pset] = x[Pord] = c[pref] = P;
  x[Iqlag] = q - of_voltage(c, V, zero);
  c[qref] = x[Iqlag] * V;
  if (value_of(c[pfFlag]) == 1.0 && value_of(P) == 0.0 && value_of(c[qref]) != 0.0)
    return "the power factor is undefined: P = 0 pu";
  c[tangent] = value_of(P) == 0.0 ? zero : c[qref] / P;
  x[M] = T(1.0);
  x[Ip] = c[start_p] = s.Tm = p;
  x[Iq] = c[start_q] = s.Efd = q;
  x[low1] = x[low0] = x[high1] = x[high0] = x[under] = x[over] = zero;
  x[least] = c[Vl1];
  x[most] = c[Vh1];
  steady_voltage(s, x);
  s.V = V;
  return {};
}

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(name, parameters, p, where, problems);
  values.require_switches({pfFlag, freqFlag, pqFlag, genFlag, vtripFlag, ftripFlag});
  values.require_times({Trv, Tp, Tiq, Tpord, Tv, tvl0, tvl1, tvh0, tvh1, tfl, tfh});
  values.require_ranges({{femax, femin}, {Pmax, Pmin}, {dPmax, dPmin}, {Iqh1, Iql1}});
  values.refuse_negative({dbd2, fdbd2, Kqv, Ddn, Dup, Kpg, Kig, dPmax});
  values.refuse_positive({dbd1, fdbd1, dPmin});
  values.require_positive({Trf, Tg, Imax, rrpwr},
                          "the equations divide by it, or the current could not change");
  values.refuse(!(p[Vrfrac] >= 0 && p[Vrfrac] <= 1), Vrfrac, "it is a fraction", "give 0 to 1");
  if (p[vtripFlag] == 0) return;
  for (const auto& [high, low] : {std::pair<int, int>{Vl1, Vl0}, {Vh0, Vh1}, {Vh1, Vl1}})
    values.refuse(!(p[high] > p[low]), values.text(high, low),
                  "units trip gradually from Vl1 to Vl0 and from Vh1 to Vh0",
                  "give Vl0 < Vl1 < Vh1 < Vh0, or vtripFlag = 0");
}

}  // namespace swingbank::sim::effects::converter_dera1
