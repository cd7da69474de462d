#pragma once
// HYG3: hydro turbine with an inelastic water column and a governor with a PID or a double derivative
// regulator.
#include <fmt/format.h>

#include <array>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/gate_power.hpp"
#include "sim/effects/detail/hydro_pid.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_hyg3 {

/// Lower bound of the flow at nominal head, a leakage [pu]: head = (flow/pgv)^2 is undefined for pgv = 0.
constexpr double kShut = 0.01;

struct Model {
  using Curve = shared::GatePower<8>;
  using Pid = shared::HydroPid;
  using Servo = shared::GateServo<Model>;
  static constexpr std::string_view
      name = "HYG3",
      title = "hydro turbine and PID or double derivative governor (WECC)",
      source =
          "CIM GovHydro3; InterPSS PsseHyg3Governor (github.com/InterPSS-Project/ipss-plugin, 8fa57f2): "
          "blocks, limits, columns, ends of the curve; PowerWorld's help, HYG3; PSS/E HYG3U1",
      dyr_name = "HYG3";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view variant_of = "HYGOV";
  static constexpr std::string_view description = R"(
  u = ref + (Rgate + Relec) dPref - Relec P/(1 + s Tt)   b(w): 0 from dbL to dbH, beyond it w minus the nearer edge
  flag 1:  u - b(w) - Rgate CV --> [ 1/(1 + s Td) ] --> [ K2 + Ki/s + s K1/(1 + s Tf) ] --> CV
  flag 0:  b(w) --> [ 1/(1 + s Td) ] --> [ s K1/(1 + s Tf) + s^2 K2/(1 + s Tf)^2 ] --y
           u - Rgate CV - y --> [ Ki/s ] --> CV
  CV and the integral of Ki: Pmin to Pmax
  CV - GV --> [ Kg/(1 + s Tp), VELclose to VELopen ] --> [ 1/s, Pmin to Pmax ] --> gate --> [ backlash ] --> GV
  backlash: GV follows the gate at the distance db2 (0: none), with a lag of 20 ms for the integration
  PGV: linear between (0, 0), (GV1, PGV1) to (GV6, PGV6), (1, 1); the ends only if the curve rises there; no
       points: PGV = GV
  TW dq/dt = H0 - h            h = (q/PGV)^2, PGV not below 0.01
  Pm = At h (q - qNL) - Dturb w GV
  Power and gate are per unit of TRATE (0: the machine's base).
)";
  enum P {
    FLAG,
    RGATE,
    RELEC,
    TT,
    TD,
    K2,
    KI,
    K1,
    TF,
    KG,
    TP,
    VELOPEN,
    VELCLOSE,
    PMAX,
    PMIN,
    DB2,
    GV1,
    PGV1,
    GV2,
    PGV2,
    GV3,
    PGV3,
    GV4,
    PGV4,
    GV5,
    PGV5,
    GV6,
    PGV6,
    H0,
    QNL,
    TW,
    AT,
    DTURB,
    TRATE,
    DBH,
    EPS,
    DBL
  };
  static constexpr int kGates[] = {GV1, GV2, GV3, GV4, GV5, GV6},
                       kPowers[] = {PGV1, PGV2, PGV3, PGV4, PGV5, PGV6};
  static constexpr Source defaults_from = literature::cim("GovHydro3");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Source kCurve = literature::own("nearly straight; CIM has no default");
  static constexpr Source kBandHz = literature::own("1.2 Hz: wider than any governor's dead-band");
  static constexpr Source kOfPid =
      literature::own("proportional gain of the PID; CIM's is that of the double derivative");
  static constexpr Parameter parameters[] = {
      {"FLAG", "flag", "code", 1.0, 0.0, 1.0, kNoNullValue, "1: PID, 0: double derivative", kAsEffect,
       shared::kCode},
      {"RGATE", "Rgate", "pu", 0.0, 0.0, 1.0, kNoNullValue,
       "permanent droop, feedback of the governor's output"},
      {"RELEC", "Relec", "pu", 0.05, 0.0, 1.0, kNoNullValue,
       "permanent droop, feedback of the electrical power"},
      {"TT", "Tt", "s", 0.2, 0.0, 20.0, 0.0, "lag of the power feedback (0: none)"},
      {"TD", "Td", "s", 0.05, 0.0, 10.0, 0.0, "input filter (0: none)"},
      {"K2", "K2", "pu", 2.5, 0.0, 100.0, kNoNullValue,
       "proportional gain (flag 1), double derivative (flag 0) [s^2]", kOfPid},
      {"KI", "Ki", "1/s", 0.5, 0.0, 100.0, kNoNullValue, "integral gain"},
      {"K1", "K1", "s", 0.01, 0.0, 100.0, 0.0, "derivative gain"},
      {"TF", "Tf", "s", 0.1, 0.0, 10.0, kNoNullValue, "washout of the derivatives"},
      {"KG", "Kg", "1/s", 2.0, 0.01, 500.0, kNoNullValue, "gate servo gain"},
      {"TP", "Tp", "s", 0.05, 0.0, 10.0, 0.0, "gate servo lag (0: none)"},
      {"VELOPEN", "VELopen", "pu/s", 0.2, 0.0001, 100.0, kNoNullValue, "fastest opening"},
      {"VELCLOSE", "VELclose", "pu/s", -0.2, -100.0, -0.0001, kNoNullValue, "fastest closing, negative"},
      upper_limit({"PMAX", "Pmax", "pu", 1.0, 0.0, 5.0, kNoNullValue, "upper limit of the gate"}),
      lower_limit({"PMIN", "Pmin", "pu", 0.0, -1.0, 1.0, kNoNullValue, "lower limit of the gate"}),
      {"db2", "db2", "MW", 0.0, 0.0, 100.0, 0.0, "half width of the gate's backlash", kAsEffect,
       literature::own("a tenth of a large unit's stroke")},
      shared::with(shared::kCurvePoints[0], 0.0, kCurve),
      shared::with(shared::kCurvePoints[1], 0.0, kCurve),
      shared::with(shared::kCurvePoints[2], 0.2, kCurve),
      shared::with(shared::kCurvePoints[3], 0.19, kCurve),
      shared::with(shared::kCurvePoints[4], 0.4, kCurve),
      shared::with(shared::kCurvePoints[5], 0.41, kCurve),
      shared::with(shared::kCurvePoints[6], 0.6, kCurve),
      shared::with(shared::kCurvePoints[7], 0.63, kCurve),
      shared::with(shared::kCurvePoints[8], 0.8, kCurve),
      shared::with(shared::kCurvePoints[9], 0.83, kCurve),
      shared::with(shared::kCurvePoints[10], 1.0, kCurve),
      shared::with(shared::kCurvePoints[11], 1.0, kCurve),
      {"H0", "H0", "pu", 1.0, 0.01, 10.0, kNoNullValue, "nominal head"},
      {"QNL", "qNL", "pu", 0.08, 0.0, 0.5, kNoNullValue, "flow at no load"},
      {"TW", "TW", "s", 1.0, 0.0, 30.0, kNoNullValue, "water starting time (0: the flow follows the gate)"},
      {"AT", "At", "pu", 1.2, 0.3, 5.0, kNoNullValue, "turbine gain"},
      {"DTURB", "Dturb", "pu", 0.2, 0.0, 5.0, 0.0, "turbine damping, power per speed at full gate"},
      {"TRATE", "TRATE", "MW", 0.0, 0.0, 10000.0, 0.0, "turbine rating (0: the machine's base)",
       shared::kNothing},
      {"DBH", "dbH", "Hz", 0.0, 0.0, 1.2, 0.0, "upper edge of the speed's dead-band", kAsEffect, kBandHz},
      {"EPS", "eps", "Hz", 0.0, 0.0, 1.2, 0.0, "hysteresis at the band's edges: 0 only", kAsEffect, kBandHz},
      {"DBL", "dbL", "Hz", 0.0, -1.2, 0.0, 0.0, "lower edge of the speed's dead-band", kAsEffect, kBandHz}};
  static constexpr auto dyr_columns = shared::columns_to<DBL>();
  enum C {
    pid = Pid::coefficients,  ///< 1: PID, 0: double derivative
    by_gate,
    by_power,
    iTT,
    upper,
    lower,
    servo,
    iTP,
    opening,
    closing,
    high,
    low,
    play,
    follow,
    head0,
    root,  ///< sqrt(H0)
    idle,
    iTW,
    gain,
    damping,
    base,  ///< machine base divided by the turbine base
    ref,
    curve,
    coefficients = curve + Curve::size
  };
  enum X { second = Pid::count, measured, velocity, gate, position, flow };
  static constexpr auto states = [] {
    std::array<State, flow + 1> all{};
    std::copy(Pid::states.begin(), Pid::states.end(), all.begin());
    all[Pid::integral] = {.name = "integral",
                          .unit = "pu",
                          .meaning = "integral of the error",
                          .low = low,
                          .high = high,
                          .moved_by = {Pid::ki},
                          .bends = true};
    all[second] = {"second", "pu/s", "derivative, lagged", 1.0, -1, -1, {Pid::iTF}};
    all[measured] = {"measured", "pu", "power fed back", 1.0, -1, -1, {iTT}};
    all[velocity] = Servo::velocity_state(iTP, closing, opening);
    all[gate] = Servo::gate_state(low, high);
    all[position] = Servo::position_state(follow);
    all[flow] = {"flow", "pu", "water flow", 1.0, -1, -1, {iTW}};
    return all;
  }();

  static void check(const double* p, const std::string& where, Problems& problems);

  /// Returns the curve's points with its ends, openings and then powers; zero after the last one.
  template <class T>
  static std::array<T, 16> points(const T* p) {
    std::array<T, 16> q;
    q.fill(T(0.0));
    std::size_t n = 0;
    const auto add = [&](const T& opening, const T& power) {
      q[n] = opening;
      q[8 + n++] = power;
    };
    const bool any = value_of(p[GV2]) > value_of(p[GV1]);
    if (any && value_of(p[GV1]) > 0.0 && value_of(p[PGV1]) > 0.0) add(T(0.0), T(0.0));
    int last = GV1;
    for (int i = GV1; any && i <= GV6; i += 2) {
      if (i > GV1 && !(value_of(p[i]) > value_of(p[last]))) break;
      add(p[i], p[i + 1]);
      last = i;
    }
    if (any && value_of(p[last]) < 1.0 && value_of(p[last + 1]) < 1.0) add(T(1.0), T(1.0));
    return q;
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    using std::sqrt;
    const T zero(0.0);
    Pid::prepare(p[TD], p[K2], p[KI], p[K1], p[TF], c);
    for (const auto& [to, from] : {std::pair<int, int>{pid, FLAG},
                                   {by_gate, RGATE},
                                   {by_power, RELEC},
                                   {servo, KG},
                                   {opening, VELOPEN},
                                   {closing, VELCLOSE},
                                   {high, PMAX},
                                   {low, PMIN},
                                   {head0, H0},
                                   {idle, QNL},
                                   {gain, AT},
                                   {damping, DTURB}})
      c[to] = p[from];
    for (const auto& [to, from] : {std::pair<int, int>{iTT, TT}, {iTP, TP}, {iTW, TW}})
      c[to] = inverse(p[from]);
    c[upper] = positive_part(p[DBH]) / T(conventions.frequency);
    c[lower] = (zero - positive_part(zero - p[DBL])) / T(conventions.frequency);
    c[root] = sqrt(p[H0]);
    const T rating = shared::turbine_rating(p[TRATE], conventions);
    c[base] = T(conventions.mva) / rating;
    c[play] = p[DB2] / rating;
    c[follow] = select(p[DB2] > zero, T(shared::kFollowRate), zero);
    constexpr int openings[] = {0, 1, 2, 3, 4, 5, 6, 7}, powers[] = {8, 9, 10, 11, 12, 13, 14, 15};
    const auto q = points(p);
    Curve::prepare(q.data(), openings, powers, c + curve);
  }
  /// Returns the output of the double-derivative governor before its limits [pu].
  template <class T>
  static T double_derivative(const T* c, const T* x, const T& u, const T& speed, T* dx) {
    const T felt = lag(c[Pid::iTD], x[Pid::filtered], speed, dx[Pid::filtered]);
    dx[Pid::lagged] = (felt - x[Pid::lagged]) * c[Pid::iTF];
    const T derivative = dx[Pid::lagged];  // derivative of the input, lagged by Tf
    dx[second] = (derivative - x[second]) * c[Pid::iTF];
    const T y = c[Pid::kd] * (felt - x[Pid::lagged]) + c[Pid::kp] * dx[second];
    dx[Pid::integral] = c[Pid::ki] * (u - c[by_gate] * x[Pid::integral] - y);
    return x[Pid::integral];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T zero(0.0);
    const T speed = positive_part(s.speed - c[upper]) - positive_part(c[lower] - s.speed);
    const T power = lag(c[iTT], x[measured], c[base] * s.P, dx[measured]);
    const T u = c[ref] + s.dGref + (c[by_gate] + c[by_power]) * s.dPref - c[by_power] * power;
    const T twice = double_derivative(c, x, u, speed, dx);
    T derivatives[Pid::count];
    const T once = Pid::evaluate(c, x, u - speed, c[by_gate], derivatives);
    const auto is_pid = c[pid] > T(0.5);
    for (int i = 0; i < Pid::count; ++i) dx[i] = select(is_pid, derivatives[i], dx[i]);
    dx[second] = select(is_pid, zero, dx[second]);
    const T cv = clamp(select(is_pid, once, twice), c[low], c[high]);
    const T gv = Servo::evaluate(c, x, cv, dx);
    const T wanted = Curve::value(c + curve, gv);
    const T pgv = select(wanted > T(kShut), wanted, T(kShut));
    const T q = select(c[iTW] > zero, x[flow], pgv * c[root]);
    const T head = square(q / pgv);
    dx[flow] = (c[head0] - head) * c[iTW];
    s.Tm = (c[gain] * head * (q - c[idle]) - c[damping] * s.speed * gv) / c[base];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    x[flow] = c[base] * s.Tm / (p[AT] * p[H0]) + p[QNL];
    const T pgv = x[flow] / c[root];
    if (value_of(pgv) < kShut)
      return fmt::format(
          "the operating point needs {:.4g} pu of the gate's curve, but a gate with less than {:g} pu is shut",
          value_of(pgv), kShut);
    x[gate] = x[position] = Curve::opening(c + curve, pgv);
    x[velocity] = x[second] = T(0.0);
    x[measured] = c[base] * s.P;
    const T error = Pid::steady(c, x[gate], x);
    c[ref] = error + c[by_gate] * x[gate] + c[by_power] * x[measured];
    return {};
  }
};

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(name, parameters, p, where, problems);
  values.refuse(p[FLAG] != 0 && p[FLAG] != 1, FLAG, "it is a code",
                "give 1 for PID or 0 for double derivative");
  values.refuse(p[EPS] != 0 && (p[DBH] != 0 || p[DBL] != 0), values.text(EPS, DBH, DBL),
                shared::kDeadBandStep, "give eps = 0");
  values.refuse(!(p[DBL] <= 0 && p[DBH] >= 0), values.text(DBH, DBL),
                "the dead-band must contain rated speed", "give dbH >= 0 and dbL <= 0");
  values.refuse_negative({RGATE, RELEC, TT, TD, K2, KI, K1, TP, DB2, QNL, TW, DTURB, TRATE},
                         "gains, times and widths cannot be negative");
  values.require_positive({KG, H0, AT}, "HYG3 divides by it, or its output could not change");
  Pid::check(values, K2, p[FLAG] == 0 ? 0.0 : p[K2], KI, p[KI], K1, p[FLAG] == 0 ? p[K1] + p[K2] : p[K1], TF,
             p[TF]);
  values.refuse(!(p[VELOPEN] > 0 && p[VELCLOSE] < 0), values.text(VELOPEN, VELCLOSE),
                "the gate must be able to open and to close", "give VELopen > 0 and VELclose < 0");
  values.require_above(PMAX, PMIN, "the range of the gate must not be empty");
  if (p[GV1] < 0)
    values.refuse(true, GV1, "it selects a curve built into PSLF", "give the curve's points");
  else
    shared::GatePower<6>::check(values, p, kGates, kPowers);
}

}  // namespace swingbank::sim::effects::governor_hyg3
