#pragma once
// PIDGOV: hydro turbine with a straight penstock and an electro-hydraulic PID governor.

#include <array>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/gate_power.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_pidgov {

struct Model {
  using Curve = shared::GatePower<4>;
  static constexpr std::string_view name = "PIDGOV", title = "hydro turbine and PID governor",
                                    source =
                                        "PSS/E PIDGOV; CIM GovHydroPID2; diagram as in the Modelica library "
                                        "karlbenoit-at-opal/modelica-ephasor-components, PIDGOV",
                                    dyr_name = "PIDGOV";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view variant_of = "HYGOV";
  static constexpr std::string_view description = R"(
  ref + dPref - back --> [ Rperm/(1 + s Treg) ] --> - w --> e         back: gate (FLAG = 1), P (FLAG = 0)
  e --> [ KP + KI/s ] --> [ 1/(1 + s TA) ] --(+)--> [ 1/(1 + s TA) ] --> c
  e --> [ KD s/(1 + s TA) ] ----------------(+)
  c - gate --> [ 1/TB ] --> [VELMIN, VELMAX] --> [ 1/s ] --> gate, [GMIN, GMAX] non-windup
  gate --> [ curve ] --> [ (1 - s ATW TW)/(1 + s ATW TW/2) ] --> - DTURB w --> Pm
  curve: linear between (G0, 0), (G1, P1), (G2, P2), (1, P3), extrapolated beyond them
)";
  enum P {
    FLAG,
    RPERM,
    TREG,
    KP,
    KI,
    KD,
    TA,
    TB,
    DTURB,
    G0,
    G1,
    P1,
    G2,
    P2,
    P3,
    GMAX,
    GMIN,
    ATW,
    TW,
    VELMAX,
    VELMIN
  };
  static constexpr Source kTuned =
      literature::own("a droop of 5 % and a gate that moves within seconds; CIM has 0");
  static constexpr Source kCurve = literature::own("an eighth of the stroke at no load, nearly straight");
  static constexpr Source defaults_from = kTuned;
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"FLAG", "Flag", "code", 1.0, 0.0, 1.0, kNoNullValue, "droop feedback: 0 electrical power, 1 gate",
       kTuned, shared::kCode},
      {"RPERM", "Rperm", "pu", 0.05, 0.0, 1.0, kNoNullValue, "permanent droop"},
      {"TREG", "Treg", "s", 0.05, 0.0, 10.0, 0.0, "lag of the droop (0: none)"},
      {"KP", "Kp", "pu", 2.0, 0.0, 100.0, kNoNullValue, "proportional gain"},
      {"KI", "Ki", "1/s", 0.5, 0.0, 100.0, kNoNullValue, "integral gain"},
      {"KD", "Kd", "s", 0.2, 0.0, 100.0, 0.0, "derivative gain"},
      {"TA", "Ta", "s", 0.05, 0.001, 10.0, kNoNullValue, "each lag of the regulator"},
      {"TB", "Tb", "s", 0.2, 0.001, 50.0, kNoNullValue, "gate servo"},
      {"DTURB", "Dturb", "pu", 0.0, 0.0, 5.0, 0.0, "turbine damping, power per speed"},
      {"G0", "G0", "pu", 0.12, 0.0, 1.0, kNoNullValue, "opening at no load", kCurve},
      {"G1", "G1", "pu", 0.5, 0.0, 1.0, kNoNullValue, "second opening", kCurve},
      {"P1", "P1", "pu", 0.45, 0.0, 2.0, kNoNullValue, "power at G1", kCurve},
      {"G2", "G2", "pu", 0.8, 0.0, 1.0, kNoNullValue, "third opening", kCurve},
      {"P2", "P2", "pu", 0.85, 0.0, 2.0, kNoNullValue, "power at G2", kCurve},
      {"P3", "P3", "pu", 1.05, 0.0, 5.0, kNoNullValue, "power at full opening", kCurve},
      upper_limit({"GMAX", "Gmax", "pu", 1.0, 0.0, 2.0, kNoNullValue, "upper limit of the gate"}),
      lower_limit({"GMIN", "Gmin", "pu", 0.0, -1.0, 1.0, kNoNullValue, "lower limit of the gate"}),
      {"ATW", "Atw", "-", 1.1, 0.0, 10.0, kNoNullValue, "factor of the water starting time Tw"},
      {"TW", "Tw", "s", 1.0, 0.0, 30.0, 0.0, "water starting time"},
      {"VELMAX", "Velmax", "pu/s", 0.2, 0.001, 10.0, kNoNullValue, "fastest opening"},
      {"VELMIN", "Velmin", "pu/s", -0.2, -10.0, -0.001, kNoNullValue, "fastest closing, negative"}};
  static constexpr int dyr_columns[] = {FLAG, RPERM, TREG, KP, KI,   KD,   TA,  TB, DTURB,  G0,    G1,
                                        P1,   G2,    P2,   P3, GMAX, GMIN, ATW, TW, VELMAX, VELMIN};
  enum C {
    by_gate,
    droop,
    iTreg,
    kp,
    ki,
    kd,
    iTA,
    iTB,
    damping,
    high,
    low,
    water_lead,
    water_lag,
    opening,
    closing,
    ref,
    curve,
    coefficients = curve + Curve::size
  };
  enum X { drooped, integral, first, derivative, asked, gate, water };
  static constexpr State states[] = {
      {"drooped", "pu", "droop signal", 1.0, -1, -1, {iTreg}},
      {"integral", "pu", "integral of the error"},
      {"first", "pu", "regulator after its first lag"},
      {"derivative", "pu", "error, lagged"},
      {"asked", "pu", "gate requested by the regulator"},
      {.name = "gate", .unit = "pu", .meaning = "gate opening", .low = low, .high = high, .bends = true},
      {"water", "pu", "state of the water column", 1.0, -1, -1, {water_lag}}};
  static constexpr int kOpenings[] = {0, 1, 2, 3}, kAtOpenings[] = {4, 5, 6, 7};
  /// Returns the curve's openings, then its powers.
  template <class T>
  static std::array<T, 8> points(const T* p) {
    return {p[G0], p[G1], p[G2], T(1.0), T(0.0), p[P1], p[P2], p[P3]};
  }

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_switches({FLAG});
    values.require_positive({TA, TB, VELMAX}, "PIDGOV divides by it, or its output could not change");
    values.refuse(!(p[VELMIN] < 0), VELMIN, "the gate closes with a negative velocity", "give Velmin < 0");
    values.refuse_negative({RPERM, TREG, KP, KI, KD, ATW, TW}, "gains and times cannot be negative");
    values.refuse(!(p[KI] > 0) && !(p[KP] > 0 && p[RPERM] > 0), values.text(KI, KP, RPERM),
                  "no gate position would be steady", "give Ki > 0, or Kp and Rperm > 0");
    values.require_above(GMAX, GMIN, "the range of the gate must not be empty");
    values.refuse(
        !(p[G0] < p[G1] && p[G1] < p[G2] && p[G2] < 1.0 && 0.0 < p[P1] && p[P1] < p[P2] && p[P2] < p[P3]),
        values.text(G0, G1, G2, P1, P2, P3), "power must rise with the opening, up to full opening",
        "give G0 < G1 < G2 < 1 and 0 < P1 < P2 < P3");
  }
  static std::string_view unphysical(const double* p) {
    return p[G0] < p[G1] && p[G1] < p[G2] && p[G2] < 1.0 && p[P1] < p[P2] && p[P2] < p[P3]
               ? ""
               : "G0 < G1 < G2 < 1, P1 < P2 < P3";
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    for (const auto& [to, from] : {std::pair<int, int>{by_gate, FLAG},
                                   {droop, RPERM},
                                   {kp, KP},
                                   {ki, KI},
                                   {kd, KD},
                                   {damping, DTURB},
                                   {high, GMAX},
                                   {low, GMIN},
                                   {opening, VELMAX},
                                   {closing, VELMIN}})
      c[to] = p[from];
    c[iTreg] = inverse(p[TREG]);
    c[iTA] = T(1.0) / p[TA];
    c[iTB] = T(1.0) / p[TB];
    const T water_time = p[ATW] * p[TW];
    c[water_lead] = T(0.0) - water_time;
    c[water_lag] = inverse(T(0.5) * water_time);
    const auto q = points(p);
    Curve::prepare(q.data(), kOpenings, kAtOpenings, c + curve);
  }
  template <class T>
  static T fed_back(const T* c, const T& gate, const Signals<T>& s) {
    return c[by_gate] * gate + (T(1.0) - c[by_gate]) * s.P;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T open = clamp(x[gate], c[low], c[high]);
    const T offset = c[droop] * (c[ref] + s.dPref + s.dGref - fed_back(c, open, s));
    const T e = lag(c[iTreg], x[drooped], offset, dx[drooped]) - s.speed;
    dx[integral] = c[ki] * e;
    dx[first] = (c[kp] * e + x[integral] - x[first]) * c[iTA];
    const T rate = c[kd] * c[iTA] * washout(c[iTA], x[derivative], e, dx[derivative]);
    dx[asked] = (x[first] + rate - x[asked]) * c[iTA];
    dx[gate] = clamp((x[asked] - x[gate]) * c[iTB], c[closing], c[opening]);
    const T power = Curve::value(c + curve, open);
    s.Tm = lead_lag(c[water_lead], c[water_lag], x[water], power, dx[water]) - c[damping] * s.speed;
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const T zero(0.0), one(1.0);
    const auto integrates = p[KI] > zero;
    x[water] = s.Tm;
    x[gate] = x[asked] = x[first] = Curve::opening(c + curve, s.Tm);
    x[integral] = select(integrates, x[gate], zero);
    // Without an integral gain, a steady error keeps the gate open.
    const T e = select(integrates, zero, x[gate] / select(integrates, one, p[KP]));
    x[drooped] = x[derivative] = e;
    c[ref] = fed_back(c, x[gate], s) + e / select(p[RPERM] > zero, p[RPERM], one);
    return {};
  }
};

}  // namespace swingbank::sim::effects::governor_pidgov
