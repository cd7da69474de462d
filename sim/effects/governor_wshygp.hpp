#pragma once
// WSHYGP: hydro turbine with a linear water column, and a PID governor with a gate curve and a backlash.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/gate_power.hpp"
#include "sim/effects/detail/hydro_pid.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_wshygp {

struct Model {
  using Curve = shared::GatePower<5>;
  using Pid = shared::HydroPid;
  using Servo = shared::GateServo<Model>;
  static constexpr std::string_view
      name = "WSHYGP",
      title = "hydro turbine and PID governor (WECC)",
      source =
          "CIM GovHydroPID; GridPACK wshygp (github.com/GridOPTICS/GridPACK): blocks, columns; OPAL-RT's "
          "Modelica library (karlbenoit-at-opal/modelica-ephasor-components), WSHYGP: backlash, limits, "
          "signal of the droop; PSS/E WSHYGP",
      dyr_name = "WSHYGP";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view variant_of = "HYGOV";
  static constexpr std::string_view description = R"(
  ref + R dPref - b(w) - R back --> [ 1/(1 + s TD) ] --> [ KP + KI/s + s KD/(1 + s TF) ] --> CV
         back: CV (TT = 0), P/(1 + s TT) (TT > 0)         b(w): 0 within +-db1, beyond it w minus the nearer edge
  CV - GV --> [ KG/(1 + s TP), VELclose to VELopen ] --> [ 1/s, PMIN to PMAX ] --> gate --> [ backlash ] --> GV
  GV --> [ NGV ] --> [ (1 + s Aturb Tturb)/(1 + s Bturb Tturb) ] --> Pm
  backlash: GV follows the gate at the distance db2 (0: none), with a lag of 20 ms for the integration
  NGV: linear between (GV1, PGV1) and (GV5, PGV5), up to the last ascending point; no points: GV
  Power and gate are per unit of TRATE (0: the machine's base). VELclose: only the magnitude counts.
)";
  enum P {
    DB1,
    ERR,
    TD,
    KI,
    TF,
    KD,
    KP,
    R,
    TT,
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
    ATURB,
    BTURB,
    TTURB,
    TRATE
  };
  static constexpr int kGates[] = {GV1, GV2, GV3, GV4, GV5}, kPowers[] = {PGV1, PGV2, PGV3, PGV4, PGV5};
  static constexpr Source defaults_from = literature::cim("GovHydroPID");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Source kStroke = literature::own("a tenth of the stroke");
  static constexpr Parameter parameters[] = {
      {"db1", "db1", "pu", 0.0, 0.0, 0.02, 0.0, "half width of the intentional dead-band of the speed",
       shared::kNothing, shared::kDeadBand},
      {"err", "err", "pu", 0.0, 0.0, 0.02, 0.0, "step at the dead-band's edge (0 or db1: none)",
       shared::kNothing, shared::kDeadBand},
      {"TD", "TD", "s", 0.0, 0.0, 10.0, 0.0, "input filter (0: none)"},
      {"KI", "KI", "1/s", 0.36, 0.0, 100.0, kNoNullValue, "integral gain"},
      {"TF", "TF", "s", 0.1, 0.0, 10.0, kNoNullValue, "washout of the derivative"},
      {"KD", "KD", "s", 1.11, 0.0, 100.0, 0.0, "derivative gain"},
      {"KP", "KP", "pu", 0.1, 0.0, 100.0, kNoNullValue, "proportional gain"},
      {"R", "R", "pu", 0.05, 0.0, 1.0, kNoNullValue, "permanent droop"},
      {"TT", "TT", "s", 0.02, 0.0, 20.0, kNoNullValue, "lag of the power feedback (0: feedback of CV)"},
      {"KG", "KG", "1/s", 2.5, 0.01, 500.0, kNoNullValue, "gate servo gain"},
      {"TP", "TP", "s", 0.35, 0.0, 10.0, 0.0, "gate servo lag (0: none)"},
      {"VELOPEN", "VELopen", "pu/s", 0.09, 0.0001, 100.0, kNoNullValue, "fastest opening"},
      {"VELCLOSE", "VELclose", "pu/s", 0.14, -100.0, 100.0, kNoNullValue,
       "fastest closing; only its magnitude counts"},
      upper_limit({"PMAX", "PMAX", "pu", 1.0, 0.0, 5.0, kNoNullValue, "upper limit of the gate"}),
      lower_limit({"PMIN", "PMIN", "pu", 0.0, -1.0, 1.0, kNoNullValue, "lower limit of the gate"}),
      {"db2", "db2", "pu", 0.0, 0.0, 0.1, 0.0, "half width of the gate's backlash", shared::kNothing,
       kStroke},
      shared::kCurvePoints[0],
      shared::kCurvePoints[1],
      shared::kCurvePoints[2],
      shared::kCurvePoints[3],
      shared::kCurvePoints[4],
      shared::kCurvePoints[5],
      shared::kCurvePoints[6],
      shared::kCurvePoints[7],
      shared::kCurvePoints[8],
      shared::kCurvePoints[9],
      {"ATURB", "Aturb", "-", -1.0, -10.0, 10.0, kNoNullValue, "turbine's lead as a multiple of Tturb"},
      {"BTURB", "Bturb", "-", 0.5, 0.0, 10.0, kNoNullValue, "turbine's lag as a multiple of Tturb"},
      {"TTURB", "Tturb", "s", 0.8, 0.0, 30.0, 0.0, "turbine time constant (0: none)"},
      {"TRATE", "TRATE", "MW", 0.0, 0.0, 10000.0, 0.0, "turbine rating (0: the machine's base)"}};
  static constexpr auto dyr_columns = shared::columns_to<TRATE>();
  enum C {
    droop = Pid::coefficients,
    by_power,
    iTT,
    band,
    servo,
    iTP,
    opening,
    closing,
    high,
    low,
    play,
    follow,
    water_lead,
    water_lag,
    base,  ///< machine base divided by the turbine base
    ref,
    curve,
    coefficients = curve + Curve::size
  };
  enum X { measured = Pid::count, velocity, gate, position, water };
  static constexpr auto states = [] {
    std::array<State, water + 1> all{};
    std::copy(Pid::states.begin(), Pid::states.end(), all.begin());
    all[measured] = {"measured", "pu", "power fed back", 1.0, -1, -1, {iTT}};
    all[velocity] = Servo::velocity_state(iTP, closing, opening);
    all[gate] = Servo::gate_state(low, high);
    all[position] = Servo::position_state(follow);
    all[water] = {"water", "pu", "state of the water column", 1.0, -1, -1, {water_lag}};
    return all;
  }();

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.refuse(p[ERR] != 0.0 && p[ERR] != p[DB1], values.text(ERR, DB1), shared::kDeadBandStep,
                  "give err = 0 or err = db1");
    values.refuse_negative({DB1, TD, KI, KD, KP, R, TT, TP, DB2, BTURB, TTURB, TRATE},
                           "gains, times and widths cannot be negative");
    values.require_positive({KG}, "a servo needs a gain");
    Pid::check(values, KP, p[KP], KI, p[KI], KD, p[KD], TF, p[TF]);
    values.refuse(!(p[VELOPEN] > 0) || p[VELCLOSE] == 0.0, values.text(VELOPEN, VELCLOSE),
                  "the gate must be able to open and to close", "give VELopen > 0 and VELclose other than 0");
    values.require_above(PMAX, PMIN, "the range of the gate must not be empty");
    values.refuse(p[TTURB] > 0 && p[BTURB] == 0.0 && p[ATURB] != 0.0, values.text(BTURB, ATURB),
                  "the water column would have a lead without a lag",
                  "give Bturb > 0, or Tturb = 0 for no water column");
    Curve::check(values, p, kGates, kPowers);
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    const T zero(0.0), one(1.0);
    Pid::prepare(p[TD], p[KP], p[KI], p[KD], p[TF], c);
    c[droop] = p[R];
    c[by_power] = select(p[TT] > zero, one, zero);
    c[iTT] = inverse(p[TT]);
    c[band] = p[DB1];
    c[servo] = p[KG];
    c[iTP] = inverse(p[TP]);
    c[opening] = p[VELOPEN];
    c[closing] = select(p[VELCLOSE] > zero, zero - p[VELCLOSE], p[VELCLOSE]);
    c[high] = p[PMAX];
    c[low] = p[PMIN];
    c[play] = p[DB2];
    c[follow] = select(p[DB2] > zero, T(shared::kFollowRate), zero);
    c[water_lead] = p[ATURB] * p[TTURB];
    c[water_lag] = inverse(p[BTURB] * p[TTURB]);
    c[base] = T(conventions.mva) / shared::turbine_rating(p[TRATE], conventions);
    Curve::prepare(p, kGates, kPowers, c + curve);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T one(1.0);
    const T power = lag(c[iTT], x[measured], c[base] * s.P, dx[measured]);
    const T asked =
        c[ref] + s.dGref + c[droop] * (s.dPref - c[by_power] * power) - dead_band(s.speed, c[band]);
    const T cv = Pid::evaluate(c, x, asked, c[droop] * (one - c[by_power]), dx);
    const T gv = Servo::evaluate(c, x, cv, dx);
    const T turbine = lead_lag(c[water_lead], c[water_lag], x[water], Curve::value(c + curve, gv), dx[water]);
    s.Tm = turbine / c[base];
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    x[water] = c[base] * s.Tm;
    x[measured] = c[base] * s.P;
    x[velocity] = T(0.0);
    x[gate] = x[position] = Curve::opening(c + curve, x[water]);
    const T error = Pid::steady(c, x[gate], x);
    c[ref] = error + c[droop] * (x[gate] + c[by_power] * (x[measured] - x[gate]));
    return {};
  }
};

}  // namespace swingbank::sim::effects::governor_wshygp
