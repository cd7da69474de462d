#pragma once
// SVSMO1: static var compensator at a switched shunt, whose thyristors control reactors and capacitors
// continuously.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/lasting.hpp"
#include "sim/effects/detail/limited_integral.hpp"
#include "sim/effects/detail/limited_lag.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/renewable.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::load_svsmo1 {

struct Model {
  static constexpr std::string_view
      name = "SVSMO1",
      title = "static var compensator at a switched shunt",
      source =
          "Pourbeik et al. (2012), Generic model structures for simulating static var systems, IEEE Trans. "
          "Power Syst. 27 (3) (WECC's svsmo1); PowerWorld, SVSMO1 (parameters, limits); InterPSS, "
          "Svsmo1t2Model (equations, columns; github.com/InterPSS-Project/ipss-plugin, 529b98f); PSS/E "
          "SVSMO1T2",
      dyr_name = "SVSMO1T2";
  static constexpr Slot slot = Slot::load;
  static constexpr std::string_view description = R"(
  V --> [ (1 + s Tc1)/(1 + s Tb1) ] --> Vm        V: of the regulated bus; Vt: at the compensator
  Vref - Vm - Xc1 Vt B --> [ dead-band ] --> [ Vemin to Vemax ] --> [ (1 + s Tc2)/(1 + s Tb2) ]
      --> [ Kpv + Kiv/s, Bmin to Btop ] --> [ 1/(1 + s T2) ] --> B        Q = B Vt^2
  dead-band: output 0 until |error| exceeds Vdbd1; then the error, until |error| has stayed within Vdbd2 for Tdbd
  Btop = Bshrt; Bmax while the request has exceeded it for longer than Tshrt; at most UVSBmax while V has been
      below UV1 for longer than UVtm1, and for PLLdelay afterwards
  The device trips (B = 0 permanently) after V has been below UVT for UVtm2, above OV1 for OVtm1
      or above OV2 for OVtm2
  Susceptances on the system's base. P is that of a conductance, P/Vt^2 at the operating point.
  Not modelled, with a remark if a record requests it: switching of mechanically switched shunts (Flag1); a slope in
  three parts (Flag2), which is Xc1 everywhere; the slow susceptance regulator (Kps, Kis); the immediate action
  below UV2, on which the sources are silent or disagree.
)";
  enum P {
    RemoteBus,
    Flag1,
    Flag2,
    UVSBmax,
    UV1,
    UV2,
    UVT,
    OV1,
    OV2,
    UVtm1,
    UVtm2,
    OVtm1,
    OVtm2,
    Xc1,
    Xc2,
    Xc3,
    Vup,
    Vlow,
    Tc1,
    Tb1,
    Tc2,
    Tb2,
    Kpv,
    Kiv,
    Vemax,
    Vemin,
    T2,
    Bshrt,
    Bmax,
    Bmin,
    Tshrt,
    Kps,
    Kis,
    Vrmax,
    Vrmin,
    Vdbd1,
    Vdbd2,
    Tdbd,
    PLLdelay,
    Eps,
    Blcs,
    Bscs,
    Blis,
    Bsis,
    Tmssbrk,
    Tdelay1,
    Tdelay2,
    Tout,
    Vrefmin,
    Vrefmax,
    parameter_count
  };
  /// The record has two flags, and eight mechanically switched shunts that are not modelled. Source of the
  /// form with an id: InterPSS, PsseSvsmo1t2ModelTest.
  static constexpr ShuntRecord at_shunt = {"SVSMO1T2", "SVSMO1T3", RemoteBus, 3, 8};
  static constexpr Source defaults_from =
      literature::interpss("PSSE_5Bus_svsmo1t2_synthetic.dyr, which PSS/E 36 ran");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Source kUnread = literature::derived("not used by the equations");
  static constexpr Source kRange = literature::own("wide enough for the Q of a load");
  static constexpr Parameter parameters[] = {
      {"RemoteBus", "J", "code", 0.0, 0.0, 999997.0, kNoNullValue,
       "bus whose voltage it regulates (0: its own)", shared::kNothing, shared::kBusNumber},
      {"Flag1", "Flag1", "code", 0.0, 0.0, 1.0, 0.0, "1: shunts are switched mechanically (not modelled)",
       kAsEffect, renewable::kFlag},
      {"Flag2", "Flag2", "code", 0.0, 0.0, 1.0, 0.0, "1: a slope in three parts (not modelled)", kAsEffect,
       renewable::kFlag},
      upper_limit({"UVSBmax", "UVSBmax", "pu", 0.18, -10.0, 10.0, kNoNullValue,
                   "upper limit while the voltage is low"}),
      {"UV1", "UV1", "pu", 0.52, 0.0, 1.0, 0.0, "voltage below which UVSBmax is the limit"},
      {"UV2", "UV2", "pu", 0.31, 0.0, 1.0, kNoNullValue, "second low voltage (not modelled)", kAsEffect,
       kUnread},
      {"UVT", "UVT", "pu", 0.48, 0.0, 1.0, 0.0, "voltage below which it trips"},
      {"OV1", "OV1", "pu", 1.8, 1.0, 99.0, kNoNullValue, "voltage above which it trips"},
      {"OV2", "OV2", "pu", 2.0, 1.0, 99.0, kNoNullValue, "second voltage above which it trips, after OVtm2"},
      {"UVtm1", "UVtm1", "s", 0.93, 0.0, 999.0, kNoNullValue, "time below UV1 until UVSBmax is the limit"},
      {"UVtm2", "UVtm2", "s", 6.7, 0.0, 999.0, kNoNullValue, "time below UVT until it trips"},
      {"OVtm1", "OVtm1", "s", 0.91, 0.0, 999.0, kNoNullValue, "time above OV1 until it trips"},
      {"OVtm2", "OVtm2", "s", 0.27, 0.0, 999.0, kNoNullValue, "time above OV2 until it trips"},
      {"Xc1", "Xc1", "pu/pu", 0.023, 0.0, 1.0, 0.0, "slope, voltage per current"},
      {"Xc2", "Xc2", "pu/pu", 0.0, 0.0, 1.0, kNoNullValue, "slope's second part (not modelled)", kAsEffect,
       kUnread},
      {"Xc3", "Xc3", "pu/pu", 0.0, 0.0, 1.0, kNoNullValue, "slope's third part (not modelled)", kAsEffect,
       kUnread},
      {"Vup", "Vup", "pu", 1.08, 0.0, 99.0, kNoNullValue,
       "voltage above which the slope is Xc1 (not modelled)", kAsEffect, kUnread},
      {"Vlow", "Vlow", "pu", 0.92, 0.0, 99.0, kNoNullValue,
       "voltage below which the slope is Xc3 (not modelled)", kAsEffect, kUnread},
      {"Tc1", "Tc1", "s", 0.0, 0.0, 10.0, 0.0, "lead of the measurement"},
      {"Tb1", "Tb1", "s", 0.012, 0.0, 10.0, kNoNullValue, "lag of the measurement (0: none)"},
      {"Tc2", "Tc2", "s", 0.0, 0.0, 10.0, 0.0, "lead of the transient gain reduction"},
      {"Tb2", "Tb2", "s", 0.0, 0.0, 50.0, kNoNullValue, "lag of the transient gain reduction (0: none)"},
      {"Kpv", "Kpv", "pu/pu", 42.0, 0.0, 1000.0, kNoNullValue, "proportional gain, susceptance per voltage"},
      {"Kiv", "Kiv", "pu/(pu s)", 210.0, 0.0, 10000.0, kNoNullValue,
       "integral gain, susceptance per voltage"},
      upper_limit({"Vemax", "Vemax", "pu", 0.45, 0.0, 99.0, kNoNullValue, "largest voltage error"}),
      lower_limit({"Vemin", "Vemin", "pu", -0.45, -99.0, 0.0, kNoNullValue, "least voltage error"}),
      {"T2", "T2", "s", 0.012, 1e-3, 10.0, kNoNullValue, "delay of the firing"},
      upper_limit({"Bshrt", "Bshrt", "pu", 3.3, 0.0, 99.0, kNoNullValue, "short-time upper limit", kRange}),
      upper_limit({"Bmax", "Bmax", "pu", 3.0, -10.0, 99.0, kNoNullValue, "continuous upper limit", kRange}),
      lower_limit({"Bmin", "Bmin", "pu", -3.0, -99.0, 10.0, kNoNullValue, "lower limit", kRange}),
      {"Tshrt", "Tshrt", "s", 0.35, 0.0, 999.0, kNoNullValue, "permissible time above Bmax"},
      {"Kps", "Kps", "pu/pu", 0.0, 0.0, 99.0, 0.0, "proportional gain of the slow regulator (not modelled)",
       kAsEffect, kUnread},
      {"Kis", "Kis", "pu/(pu s)", 0.0, 0.0, 99.0, 0.0, "integral gain of the slow regulator (not modelled)",
       kAsEffect, kUnread},
      upper_limit({"Vrmax", "Vrmax", "pu", 0.0, 0.0, 99.0, kNoNullValue,
                   "highest output of the slow regulator", kAsEffect, kUnread}),
      lower_limit({"Vrmin", "Vrmin", "pu", 0.0, -99.0, 0.0, kNoNullValue,
                   "lowest output of the slow regulator", kAsEffect, kUnread}),
      {"Vdbd1", "Vdbd1", "pu", 0.0, 0.0, 0.5, 0.0, "error beyond which it begins to act (0: no dead-band)"},
      {"Vdbd2", "Vdbd2", "pu", 0.0, 0.0, 0.5, kNoNullValue, "error within which it stops acting"},
      {"Tdbd", "Tdbd", "s", 0.0, 0.0, 999.0, kNoNullValue, "time within Vdbd2 until it stops acting"},
      {"PLLdelay", "PLLdelay", "s", 0.13, 0.0, 99.0, kNoNullValue,
       "time for which UVSBmax is kept after a low voltage"},
      {"Eps", "Eps", "Mvar", 0.4, 0.0, 999.0, kNoNullValue, "width added to the slow regulator's band",
       kAsEffect, kUnread},
      {"Blcs", "Blcs", "Mvar", 37.0, -9999.0, 9999.0, kNoNullValue, "large threshold, capacitive", kAsEffect,
       kUnread},
      {"Bscs", "Bscs", "Mvar", 19.0, -9999.0, 9999.0, kNoNullValue, "small threshold, capacitive", kAsEffect,
       kUnread},
      {"Blis", "Blis", "Mvar", -38.0, -9999.0, 9999.0, kNoNullValue, "large threshold, inductive", kAsEffect,
       kUnread},
      {"Bsis", "Bsis", "Mvar", -18.0, -9999.0, 9999.0, kNoNullValue, "small threshold, inductive", kAsEffect,
       kUnread},
      {"Tmssbrk", "Tmssbrk", "s", 0.09, 0.0, 999.0, kNoNullValue, "delay of the switched shunts' breaker",
       kAsEffect, kUnread},
      {"Tdelay1", "Tdelay1", "s", 0.47, 0.0, 999.0, kNoNullValue, "delay beyond the large threshold",
       kAsEffect, kUnread},
      {"Tdelay2", "Tdelay2", "s", 2.8, 0.0, 999.0, kNoNullValue, "delay beyond the small threshold",
       kAsEffect, kUnread},
      {"Tout", "Tout", "s", 280.0, 0.0, 9999.0, kNoNullValue, "discharge time of a switched capacitor",
       kAsEffect, kUnread},
      lower_limit({"Vrefmin", "Vrefmin", "pu", 0.8, 0.0, 99.0, kNoNullValue,
                   "lowest reference of the slow regulator", kAsEffect, kUnread}),
      upper_limit({"Vrefmax", "Vrefmax", "pu", 1.2, 0.0, 99.0, kNoNullValue,
                   "highest reference of the slow regulator", kAsEffect, kUnread})};
  static constexpr auto dyr_columns = shared::columns_to<parameter_count - 1>();
  /// The first coefficients are the parameters themselves.
  enum C {
    iTb1 = parameter_count,
    iTb2,
    iT2,
    iPLL,
    banded,  ///< 1 if there is a dead-band
    Vref,
    conductance,
    coefficients
  };
  enum X { Vm, e, PI, B, calm, low, held, above, under, over1, over2 };
  static constexpr auto states = [] {
    constexpr auto timer = [](std::string_view symbol, std::string_view meaning) {
      return State{.name = symbol, .unit = "s", .meaning = meaning, .bends = true};
    };
    constexpr auto of_gain = [](std::string_view symbol, std::string_view meaning, double weight) {
      return State{.name = symbol, .unit = "pu", .meaning = meaning, .weight = weight, .bends = true};
    };
    return std::array{
        of_gain("Vm", "measured voltage", 20.0),  // weight: Kpv amplifies its error
        of_gain("e", "state of the transient gain reduction", 20.0),
        of_gain("PI", "integral of the regulator", 1.0),
        of_gain("B", "susceptance", 1.0),
        timer("calm", "time of an error within Vdbd2"),
        timer("low", "time below UV1"),
        State{.name = "held", .unit = "-", .meaning = "1 while UVSBmax is the limit", .bends = true},
        timer("above", "time above Bmax"),
        timer("under", "time below UVT"),
        timer("over1", "time above OV1"),
        timer("over2", "time above OV2")};
  }();

  static void check(const double* p, const std::string& where, Problems& problems);
  static std::string remark(const double* p);

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    std::copy(p, p + parameter_count, c);
    c[iTb1] = inverse(p[Tb1]);
    c[iTb2] = inverse(p[Tb2]);
    c[iT2] = T(1.0) / p[T2];
    c[iPLL] = T(1.0) / renewable::larger(p[PLLdelay], T(renewable::kFollow));
    c[banded] = select(p[Vdbd1] > T(0.0), T(1.0), T(0.0));
  }
  template <class T>
  static void current(const T* c, const T* x, Signals<T>& s) {
    s.Ir = x[B] * s.Vi - c[conductance] * s.Vr;
    s.Ii = T(0.0) - x[B] * s.Vr - c[conductance] * s.Vi;
  }
  template <class T>
  static void derivative(const T* c, const T* x, const Signals<T>& s, T* dx) {
    const T V = magnitude(s.Vpr, s.Vpi);
    const T measured = lead_lag(c[Tc1], c[iTb1], x[Vm], V, dx[Vm]);
    const T error = c[Vref] - measured - c[Xc1] * magnitude(s.Vr, s.Vi) * x[B];
    const T acts = clamp(awake(c, error, x[calm], dx[calm]) * error, c[Vemin], c[Vemax]);
    const T u = lead_lag(c[Tc2], c[iTb2], x[e], acts, dx[e]);
    const T asked = c[Kpv] * u + x[PI], most = top(c, x, V, asked, dx);
    dx[PI] = shared::non_windup(c[Kiv] * u, asked, c[Bmin], most) -
             T(shared::kReturn) * (x[PI] - clamp(x[PI], c[Bmin], most));
    dx[B] = (on(c, x, V, dx) * clamp(asked, c[Bmin], most) - x[B]) * c[iT2];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x);

 private:
  /// Returns 0 for `much` <= 0 and 1 for `much` >= kDipBand, linear between. `much`: distance of a quantity
  /// beyond its threshold [pu].
  template <class T>
  static T beyond(const T& much) {
    return clamp(much * T(1.0 / renewable::kDipBand), T(0.0), T(1.0));
  }
  /// Returns 1 if the regulator acts on its error, 0 within the dead-band. The transition at the edges of the
  /// dead-band has the width kWakingBand, less than the width kDipBand at voltage thresholds.
  template <class T>
  static T awake(const T* c, const T& error, const T& x, T& dx) {
    const T zero(0.0), one(1.0), size = renewable::larger(error, zero - error), per_edge(1.0 / kWakingBand);
    const T inside = clamp((c[Vdbd2] - size) * per_edge, zero, one);
    const T outside = clamp((size - c[Vdbd1]) * per_edge, zero, one);
    const T past = (x - c[Tdbd]) * T(1.0 / renewable::kFading), asleep = clamp(past, zero, one);
    const T falls = outside + (one - outside) * (one - asleep) * (one - inside);
    dx = c[banded] * (inside * clamp(T(2.0) - past, zero, one) - falls * x * T(1.0 / renewable::kFollow));
    return one - c[banded] * asleep;
  }
  /// Returns the upper limit of the regulator's output [pu].
  template <class T>
  static T top(const T* c, const T* x, const T& V, const T& asked, T* dx) {
    const T zero(0.0), one(1.0);
    const T long_low = shared::lasting(beyond(c[UV1] - V), c[UVtm1], x[low], dx[low]);
    dx[held] = long_low * (one - x[held]) * T(1.0 / renewable::kFollow) -
               (one - long_low) * clamp(x[held] * T(1.0 / kWakingBand), zero, one) * c[iPLL];
    const T long_above = shared::lasting(beyond(asked - c[Bmax]), c[Tshrt], x[above], dx[above]);
    const T usual = c[Bshrt] - long_above * (c[Bshrt] - c[Bmax]);
    const T share = clamp(x[held] * T(1.0 / kWakingBand), zero, one);
    return renewable::larger(c[Bmin], usual - share * positive_part(usual - c[UVSBmax]));
  }
  /// Returns 1 until a trip, then 0.
  template <class T>
  static T on(const T* c, const T* x, const T& V, T* dx) {
    const T one(1.0);
    return (one - shared::passed(beyond(c[UVT] - V), c[UVtm2], x[under], dx[under])) *
           (one - shared::passed(beyond(V - c[OV1]), c[OVtm1], x[over1], dx[over1])) *
           (one - shared::passed(beyond(V - c[OV2]), c[OVtm2], x[over2], dx[over2]));
  }

  static constexpr double kWakingBand = 1e-4;  ///< transition width of the dead-band [pu] and of `held`
};

template <class T>
std::string Model::steady(const T* p, T* c, Signals<T>& s, T* x) {
  const T square_2 = s.Vr * s.Vr + s.Vi * s.Vi, zero(0.0);
  const T V = magnitude(s.Vpr, s.Vpi);
  c[conductance] = zero - (s.Vr * s.Ir + s.Vi * s.Ii) / square_2;
  x[B] = x[PI] = (s.Vi * s.Ir - s.Vr * s.Ii) / square_2;
  const double b = value_of(x[B]), v = value_of(V);
  if (b < value_of(p[Bmin]) || b > value_of(p[Bmax]))
    return fmt::format(
        "its susceptance at the operating point, B = {:.4f} pu, is outside Bmin = {:g} pu to Bmax = {:g} pu",
        b, value_of(p[Bmin]), value_of(p[Bmax]));
  if (v < std::max(value_of(p[UV1]), value_of(p[UVT])) || v > std::min(value_of(p[OV1]), value_of(p[OV2])))
    return fmt::format(
        "its protection acts at V = {:.4f} pu: UV1 = {:g}, UVT = {:g}, OV1 = {:g}, OV2 = {:g} pu", v,
        value_of(p[UV1]), value_of(p[UVT]), value_of(p[OV1]), value_of(p[OV2]));
  x[Vm] = V;
  c[Vref] = V + p[Xc1] * magnitude(s.Vr, s.Vi) * x[B];
  x[e] = x[low] = x[held] = x[above] = x[under] = x[over1] = x[over2] = zero;
  x[calm] = p[Tdbd] + T(2.0 * renewable::kFading);  // inactive within the dead-band
  return {};
}

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(name, parameters, p, where, problems);
  values.require_switches({Flag1, Flag2});
  values.require_numbers({RemoteBus});
  for (int i = 0; i < parameter_count; ++i)
    values.refuse(parameters[i].unit == "s" && !(p[i] >= 0.0), i, "a time cannot be negative",
                  "give a value >= 0");
  values.refuse_negative({Kpv, Kiv, Xc1, Vdbd2}, "the control would be unstable");
  values.refuse(p[T2] == 0.0, T2, "the voltage would form an algebraic loop", "give a value > 0");
  for (const auto& [high, low_one] : {std::pair<int, int>{Bmax, Bmin}, {Bshrt, Bmax}, {Vdbd1, Vdbd2}})
    values.refuse(!(p[high] >= p[low_one]), values.text(high, low_one),
                  "the first value must not be below the second", "swap them");
  values.refuse(!(p[Vemax] >= 0.0 && p[Vemin] <= 0.0), values.text(Vemax, Vemin),
                "an error of 0 must lie between them", "give Vemax >= 0 >= Vemin");
}

/// Returns a remark on features that the record requests and the equations omit, or "".
inline std::string Model::remark(const double* p) {
  std::string text;
  const auto add = [&](bool asked, const std::string& what) {
    if (asked) text += (text.empty() ? "" : "; ") + what;
  };
  add(p[Flag1] == 1.0, "Flag1 = 1: mechanically switched shunts are not switched");
  add(p[Flag2] == 1.0, "Flag2 = 1: the slope is Xc1 everywhere");
  add(p[Kps] != 0.0 || p[Kis] != 0.0, "the slow susceptance regulator (Kps, Kis) is not modelled");
  add(p[UV2] > 0.0, fmt::format("the immediate action below UV2 = {:g} pu is not modelled", p[UV2]));
  return text;
}

}  // namespace swingbank::sim::effects::load_svsmo1
