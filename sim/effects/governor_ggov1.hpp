#pragma once
// GGOV1: gas turbine or engine under a PID governor, with load (temperature) and acceleration limiter.
//
// PSS/E computes the acceleration limiter's output as the stroke of the previous step plus Ka (Aset -
// acceleration) dt. The stroke thus rises no faster than Ka (Aset - acceleration). Here the state `accel`
// imposes this rate independent of the step size. It follows the lower output of the other two controllers,
// at the distance kAbove above it, with the time constant kFollow. A stroke that rises slower than both
// kAbove/kFollow and Ka (Aset - acceleration) thus does not reach `accel`.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_ggov1 {

struct Model {
  static constexpr std::string_view
      name = "GGOV1",
      title = "gas turbine or engine, PID governor, load and acceleration limiter",
      source = "IEEE PES-TR1 (2013), 3.1.2.3; NERC, Gas turbine governor modeling (2017); PSS/E GGOV1",
      dyr_name = "GGOV1";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view description = R"(
  e = Pref + R dPref + mw - R f - w --> [ db ] --> [ minerr, maxerr ] --error
  error --> Kpgov + Kigov/s + s Kdgov/(1 + s Tdgov) --> FSRN
      f: measured power (Rselect 1), valve (-1), requested stroke (-2), nothing (0)
      measured power = P/(1 + s Tpelec)      mw = Kimw/s (Pmwset - measured power) within +-1.1 R
  Ldref/Kturb + Wfnl - exhaust --> Kpload + Kiload/s <= 1 --> FSRT      (the integral moves within Rdown, Rup)
  stroke = min(FSRN, FSRT) within Vmin, Vmax, rising no faster than Ka (Aset - s w/(1 + s Ta))  (Ka = 0: off)
  stroke --> [ 1/(1 + s Tact), speed Rclose to Ropen, Vmin to Vmax ] --valve--> x (1 + w if Flag = 1) --> fuel
  Pm = (1 + s Tc)/(1 + s Tb) Kturb (fuel - Wfnl) - Dm (1 + w)           (the last term if Dm > 0)
  exhaust = (1 + s Tsa)/((1 + s Tsb)(1 + s Tfload)) fuel (1 + w)^Dm     (the last factor if Dm < 0)
  per unit of Trate (0: the machine's base); integrals within Vmin and Vmax (FSRT: 1), without wind-up
)";
  enum P {
    Rselect,
    Flag,
    R,
    Tpelec,
    maxerr,
    minerr,
    Kpgov,
    Kigov,
    Kdgov,
    Tdgov,
    Vmax,
    Vmin,
    Tact,
    Kturb,
    Wfnl,
    Tb,
    Tc,
    Teng,
    Tfload,
    Kpload,
    Kiload,
    Ldref,
    Dm,
    Ropen,
    Rclose,
    Kimw,
    Aset,
    Ka,
    Ta,
    Trate,
    db,
    Tsa,
    Tsb,
    Rup,
    Rdown
  };
  static constexpr Source defaults_from = literature::openipsl("test of GGOV1");
  static constexpr Source bounds_from = literature::own(
      "sign required by the equations; at least five times CIM's GovCT1; 99 and 999: no limit");
  static constexpr Parameter parameters[] = {
      {"Rselect", "Rselect", "code", 1.0, -2.0, 1.0, kNoNullValue,
       "droop feedback: 1 electrical power, 0 none, -1 valve, -2 requested stroke", literature::cim("GovCT1"),
       shared::kCode},
      {"Flag", "Flag", "code", 0.0, 0.0, 1.0, kNoNullValue, "1: fuel flow in proportion to speed", kAsEffect,
       shared::kCode},
      {"R", "R", "pu", 0.04, 0.0, 1.0, kNoNullValue, "permanent droop", literature::cim("GovCT1")},
      {"Tpelec", "Tpelec", "s", 1.0, 0.0, 30.0, kNoNullValue, "power transducer (0: none)"},
      upper_limit({"maxerr", "maxerr", "pu", 0.05, 0.0, 1.0, kNoNullValue, "upper limit of the speed error"}),
      lower_limit(
          {"minerr", "minerr", "pu", -0.05, -1.0, 0.0, kNoNullValue, "lower limit of the speed error"}),
      {"Kpgov", "Kpgov", "pu/pu", 10.0, 0.0, 100.0, kNoNullValue, "proportional gain"},
      {"Kigov", "Kigov", "1/s", 2.0, 0.0, 50.0, kNoNullValue, "integral gain"},
      {"Kdgov", "Kdgov", "s", 0.0, 0.0, 50.0, 0.0, "derivative gain"},
      {"Tdgov", "Tdgov", "s", 1.0, 0.0, 10.0, kNoNullValue, "time constant of the derivative"},
      upper_limit({"Vmax", "Vmax", "pu", 1.0, 0.0, 2.0, kNoNullValue, "upper limit of the valve", kAsEffect,
                   literature::own("twice the rated opening")}),
      lower_limit({"Vmin", "Vmin", "pu", 0.15, -0.5, 1.0, kNoNullValue, "lower limit of the valve", kAsEffect,
                   literature::own("from half a stroke below the closed valve to the rated opening")}),
      {"Tact", "Tact", "s", 0.5, 0.01, 20.0, kNoNullValue, "actuator time constant"},
      {"Kturb", "Kturb", "pu/pu", 1.5, 0.1, 10.0, kNoNullValue, "turbine gain"},
      {"Wfnl", "Wfnl", "pu", 0.2, 0.0, 1.0, kNoNullValue, "fuel flow at no load"},
      {"Tb", "Tb", "s", 0.1, 0.0, 20.0, kNoNullValue, "turbine lag (0: none)"},
      {"Tc", "Tc", "s", 0.0, 0.0, 20.0, kNoNullValue, "turbine lead"},
      {"Teng", "Teng", "s", 0.0, 0.0, 0.0, 0.0, "transport delay of a diesel engine: 0 only", kAsEffect,
       shared::kNotModelled},
      {"Tfload", "Tfload", "s", 3.0, 0.0, 30.0, kNoNullValue, "load limiter's measurement (0: none)"},
      {"Kpload", "Kpload", "pu/pu", 2.0, 0.0, 50.0, kNoNullValue, "load limiter, proportional gain"},
      {"Kiload", "Kiload", "1/s", 0.67, 0.0, 20.0, kNoNullValue, "load limiter, integral gain"},
      upper_limit(
          {"Ldref", "Ldref", "pu", 1.0, 0.0, 5.0, kNoNullValue, "load limiter's reference, as power"}),
      {"Dm", "Dm", "pu", 0.0, -2.0, 5.0, 0.0,
       "> 0: power lost in proportion to speed; < 0: exponent of speed in the exhaust temperature"},
      {"Ropen", "Ropen", "pu/s", 0.1, 0.0, 99.0, kNoNullValue, "fastest opening"},
      {"Rclose", "Rclose", "pu/s", -0.1, -99.0, 0.0, kNoNullValue, "fastest closing"},
      {"Kimw", "Kimw", "1/s", 0.0, 0.0, 1.0, 0.0, "gain of the power controller"},
      {"Aset", "Aset", "pu/s", 0.1, 0.0, 99.0, kNoNullValue, "acceleration limiter's reference"},
      {"Ka", "Ka", "1/s", 10.0, 0.0, 999.0, 0.0, "acceleration limiter's gain (0: none)"},
      {"Ta", "Ta", "s", 0.1, 0.0, 10.0, kNoNullValue, "acceleration limiter's measurement"},
      {"Trate", "Trate", "MW", 0.0, 0.0, 10000.0, 0.0, "turbine rating (0: the machine's base)", kAsEffect,
       literature::own("larger than any turbine")},
      {"db", "db", "pu", 0.0, 0.0, 0.1, 0.0, "half width of the dead-band of the speed error"},
      {"Tsa", "Tsa", "s", 4.0, 0.0, 50.0, kNoNullValue, "exhaust temperature, lead"},
      {"Tsb", "Tsb", "s", 5.0, 0.0, 50.0, kNoNullValue, "exhaust temperature, lag (0: none)"},
      {"Rup", "Rup", "pu/s", 99.0, 0.0, 99.0, kNoNullValue, "load limit's fastest rise"},
      {"Rdown", "Rdown", "pu/s", -99.0, -99.0, 0.0, kNoNullValue, "load limit's fastest fall"}};
  static constexpr auto dyr_columns = shared::columns_to<Rdown>();
  static constexpr double kAbove = 0.002;   ///< distance of `accel` above the other outputs [pu of stroke]
  static constexpr double kFollow = 0.002;  ///< time constant with which `accel` follows these outputs [s]
  static constexpr double kFullLoad = 1.0;  ///< upper limit of the load limiter's output [pu of stroke]
  enum C {
    droop,
    droop_power,
    droop_valve,
    droop_stroke,
    inverse_loop,
    iTpelec,
    most,
    least,
    kp,
    ki,
    kd,
    iTdgov,
    high,
    low,
    full,
    iTact,
    kturb,
    wfnl,
    iTb,
    tc,
    iTfload,
    kpload,
    kiload,
    limit,  ///< Ldref/Kturb + Wfnl
    loss,
    exponent,
    fuel_speed,
    ropen,
    rclose,
    kimw,
    mw_high,
    mw_low,
    aset,
    ka,
    iTa,
    base,  ///< machine base divided by the turbine rating
    band,
    tsa,
    iTsb,
    rup,
    rdown,
    Pref,
    Pmwset,
    coefficients
  };
  enum X { power, mw, integral, rate, swing, accel, heat, exhaust, load, valve, turbine };
  static constexpr State states[] = {{"power", "pu", "measured electrical power"},
                                     {"mw", "pu", "power controller", 1.0, mw_low, mw_high},
                                     {"integral", "pu", "governor's integral", 1.0, low, high},
                                     {"rate", "pu", "lag of the governor's derivative"},
                                     {"swing", "pu", "lag of the acceleration's measurement"},
                                     {"accel", "pu", "acceleration limiter", 1.0, low, -1},
                                     {"heat", "pu", "lag of the exhaust temperature"},
                                     {"exhaust", "pu", "measured exhaust temperature, as fuel flow"},
                                     {"load", "pu", "load limiter's integral", 1.0, low, full},
                                     {"valve", "pu", "fuel valve", 1.0, low, high},
                                     {"turbine", "pu", "turbine power"}};

  static void check(const double* p, const std::string& where, Problems& problems);

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    const T zero(0.0);
    const double code = value_of(p[Rselect]);
    c[droop] = p[R];
    c[droop_power] = code == 1.0 ? p[R] : zero;
    c[droop_valve] = code == -1.0 ? p[R] : zero;
    c[droop_stroke] = code == -2.0 ? p[R] : zero;
    c[iTpelec] = inverse(p[Tpelec]);
    c[most] = p[maxerr];
    c[least] = p[minerr];
    c[iTdgov] = inverse(p[Tdgov]);
    c[kp] = p[Kpgov];
    c[ki] = p[Kigov];
    c[kd] = p[Kdgov] * c[iTdgov];
    c[inverse_loop] = T(1.0) / (T(1.0) + c[droop_stroke] * (c[kp] + c[kd]));
    c[high] = p[Vmax];
    c[low] = p[Vmin];
    c[full] = T(kFullLoad);
    c[iTact] = T(1.0) / p[Tact];
    c[kturb] = p[Kturb];
    c[wfnl] = p[Wfnl];
    c[iTb] = inverse(p[Tb]);
    c[tc] = p[Tc];
    c[iTfload] = inverse(p[Tfload]);
    c[kpload] = p[Kpload];
    c[kiload] = p[Kiload];
    c[limit] = p[Ldref] / p[Kturb] + p[Wfnl];
    c[loss] = select(p[Dm] < zero, zero, p[Dm]);  // at Dm = 0 a dual number has the derivative for Dm > 0
    c[exponent] = select(p[Dm] < zero, p[Dm], zero);
    c[fuel_speed] = p[Flag];
    c[ropen] = p[Ropen];
    c[rclose] = p[Rclose];
    c[kimw] = p[Kimw];
    c[mw_high] = T(1.1) * p[R];
    c[mw_low] = zero - c[mw_high];
    c[aset] = p[Aset];
    c[ka] = p[Ka];
    c[iTa] = inverse(p[Ta]);
    const auto rated = p[Trate] > zero;
    c[base] = select(rated, T(conventions.mva) / select(rated, p[Trate], T(1.0)), T(1.0));
    c[band] = p[db];
    c[tsa] = p[Tsa];
    c[iTsb] = inverse(p[Tsb]);
    c[rup] = p[Rup];
    c[rdown] = p[Rdown];
  }

  template <class T>
  static T lower(const T& a, const T& b) {
    return select(a < b, a, b);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T position = clamp(x[valve], c[low], c[high]), turning = T(1.0) + s.speed;
    const T fuel = position * (T(1.0) + c[fuel_speed] * s.speed);
    const T texm = exhaust_temperature(c, x, fuel, turning, dx);
    const T stroke = requested(c, x, position, texm, s, dx);
    dx[valve] = clamp((stroke - position) * c[iTact], c[rclose], c[ropen]);
    const T gross_power = lead_lag(c[tc], c[iTb], x[turbine], c[kturb] * (fuel - c[wfnl]), dx[turbine]);
    s.Tm = (gross_power - c[loss] * turning) / c[base];
  }
  template <class T>
  static T exhaust_temperature(const T* c, const T* x, const T& fuel, const T& turning, T* dx) {
    using std::exp;
    using std::log;
    const T rising = select(turning > T(0.01), turning, T(0.01));  // the logarithm needs a speed > 0
    const T hot = fuel * exp(c[exponent] * log(rising));
    return lag(c[iTfload], x[exhaust], lead_lag(c[tsa], c[iTsb], x[heat], hot, dx[heat]), dx[exhaust]);
  }
  /// Returns the lowest stroke of the three controllers [pu]. `texm`: measured exhaust temperature.
  template <class T>
  static T requested(const T* c, const T* x, const T& position, const T& texm, const Signals<T>& s, T* dx) {
    const T measured = lag(c[iTpelec], x[power], s.P * c[base], dx[power]);
    dx[mw] = c[kimw] * (c[Pmwset] - measured);
    const T asked = c[Pref] + s.dGref + c[droop] * s.dPref + clamp(x[mw], c[mw_low], c[mw_high]) - s.speed -
                    c[droop_power] * measured - c[droop_valve] * position;
    const T hotter = c[limit] - texm;
    dx[load] = clamp(c[kiload] * hotter, c[rdown], c[rup]);
    const T fsrt = lower(clamp(x[load], c[low], c[full]) + c[kpload] * hotter, c[full]);
    // With droop on the stroke, stroke = gain error(asked - droop stroke) + rest has one solution. If another
    // controller determines the stroke, the droop acts on that stroke.
    const T gain = c[kp] + c[kd], rest = clamp(x[integral], c[low], c[high]) - c[kd] * x[rate];
    const T free =
        clamp(dead_band(asked - c[droop_stroke] * rest, c[band]) * c[inverse_loop], c[least], c[most]);
    const T wanted = clamp(lower(gain * free + rest, fsrt), c[low], c[high]);
    const auto limits = c[ka] > T(0.0);
    const T ceiling = select(limits, clamp(x[accel], c[low], c[high]), wanted);
    const T stroke = lower(wanted, ceiling);
    const T error = clamp(dead_band(asked - c[droop_stroke] * stroke, c[band]), c[least], c[most]);
    dx[integral] = c[ki] * error;
    dx[rate] = (error - x[rate]) * c[iTdgov];
    const T acceleration = dx[swing] = (s.speed - x[swing]) * c[iTa];
    const T follow = (wanted + T(kAbove) - x[accel]) * T(1.0 / kFollow);
    dx[accel] = select(limits, lower(follow, c[ka] * (c[aset] - acceleration)), follow);
    return stroke;
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const T pe = s.P * c[base], fuel = (s.Tm * c[base] + c[loss]) / c[kturb] + c[wfnl];
    const double stroke = value_of(fuel);
    const auto refuse = [&](const char* what, double bound) {
      return fmt::format("the operating point needs a stroke of {:.4g} pu, {} = {:.4g} pu", stroke, what,
                         bound);
    };
    if (stroke > value_of(p[Vmax])) return refuse("above Vmax", value_of(p[Vmax]));
    if (stroke < value_of(p[Vmin])) return refuse("below Vmin", value_of(p[Vmin]));
    if (stroke > kFullLoad) return refuse("above the load limiter's largest output", kFullLoad);
    if (stroke > value_of(c[limit]))
      return fmt::format(
          "the operating point needs {:.4g} pu of power, above the load limit Ldref = {:.4g} pu",
          value_of(s.Tm * c[base] + c[loss]), value_of(p[Ldref]));
    c[Pmwset] = x[power] = pe;
    x[mw] = x[rate] = x[swing] = T(0.0);
    x[integral] = x[heat] = x[exhaust] = x[valve] = fuel;
    x[accel] = fuel + T(kAbove);
    x[load] = c[full];
    x[turbine] = c[kturb] * (fuel - c[wfnl]);
    c[Pref] = c[droop_power] * pe + (c[droop_valve] + c[droop_stroke]) * fuel;
    return {};
  }
};

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(name, parameters, p, where, problems);
  values.refuse(p[Rselect] != 1 && p[Rselect] != 0 && p[Rselect] != -1 && p[Rselect] != -2, Rselect,
                "it selects the droop's signal", "give 1, 0, -1 or -2");
  values.require_switches({Flag});
  values.refuse(p[Teng] != 0, Teng, "a transport delay is not modelled",
                "give Teng = 0; the response is then as fast as the actuator");
  values.require_positive({Tact, Kturb, Ropen, Rup}, "the output would be constant");
  for (const int i : {Rclose, Rdown})
    values.refuse(!(p[i] < 0), i, "the output would be constant", "give a value < 0");
  values.refuse_negative({R, Tpelec, maxerr, Kpgov, Kigov, Kdgov, Tb, Tc, Tfload, Kpload, Kiload, Kimw, Aset,
                          Ka, Trate, db, Tsa, Tsb},
                         "it cannot be negative");
  values.refuse_positive({minerr}, "a lower limit of the error cannot be positive");
  values.require_above(Vmax, Vmin, "the range of the valve must not be empty");
  values.refuse(!(p[Vmin] < kFullLoad), Vmin, "the load limiter's output is at most 1 pu", "give Vmin < 1");
  values.require_time(Tdgov, p[Kdgov] > 0, "Kdgov = 0");
  values.require_time(Ta, p[Ka] > 0, "Ka = 0");
  values.require_finite({Wfnl, Ldref, Dm});
}

}  // namespace swingbank::sim::effects::governor_ggov1
