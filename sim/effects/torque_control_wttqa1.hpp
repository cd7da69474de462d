#pragma once
// WTTQA1: torque control of a wind turbine, which sets the power reference from the speed.
#include <fmt/format.h>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/renewable.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::torque_control_wttqa1 {

struct Model {
  static constexpr std::string_view name = "WTTQA1", title = "torque control of a wind turbine, type A",
                                    source =
                                        "WECC (2014), Wind plant dynamic modeling guidelines, WTGTRQ_A; "
                                        "PSS/E WTTQA1",
                                    dyr_name = "WTTQA1";
  static constexpr Slot slot = Slot::torque_control;
  static constexpr std::string_view description = R"(
  P/(1 + s Tp) --> f(P): linear between the points (p, spd) --> [ 1/(1 + s Twref) ] --> wref
  wg - wref (Tflag 0), (Pref - P)/(1 + wg) (Tflag 1) --> [ Kpp + Kip/s, Temin to Temax ] --> x (1 + wg) --> Pext
  Pref: the plant control's Pext; per unit of TRATE (0: the converter's base)
)";
  enum P { Tflag, Kpp, Kip, Tp, Twref, Temax, Temin, p1, spd1, p2, spd2, p3, spd3, p4, spd4, TRATE };
  static constexpr Source defaults_from = literature::andes("WTTQA1");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Parameter parameters[] = {
      {"Tflag", "Tflag", "code", 0.0, 0.0, 1.0, kNoNullValue, "regulated quantity: 0 speed, 1 power",
       kAsEffect, renewable::kFlag},
      {"Kpp", "Kpp", "pu/pu", 0.0, 0.0, 100.0, 0.0, "proportional gain"},
      {"Kip", "Kip", "1/s", 0.1, 0.0, 100.0, 0.0, "integral gain"},
      {"Tp", "Tp", "s", 0.05, 0.0, 10.0, kNoNullValue, "lag of the power measurement (0: none)"},
      {"Twref", "Twref", "s", 30.0, 0.0, 300.0, kNoNullValue, "lag of the speed reference (0: none)"},
      upper_limit({"Temax", "Temax", "pu", 1.2, 0.0, 99.0, kNoNullValue, "largest torque"}),
      lower_limit({"Temin", "Temin", "pu", 0.0, -1.0, 1.0, kNoNullValue, "smallest torque"}),
      {"p1", "p1", "pu", 0.2, -1.0, 2.0, kNoNullValue, "power of point 1"},
      {"spd1", "spd1", "pu", 0.58, 0.1, 2.0, kNoNullValue, "speed at p1"},
      {"p2", "p2", "pu", 0.4, 0.0, 2.0, kNoNullValue, "power of point 2"},
      {"spd2", "spd2", "pu", 0.72, 0.1, 2.0, kNoNullValue, "speed at p2"},
      {"p3", "p3", "pu", 0.6, 0.0, 2.0, kNoNullValue, "power of point 3"},
      {"spd3", "spd3", "pu", 0.86, 0.1, 2.0, kNoNullValue, "speed at p3"},
      {"p4", "p4", "pu", 0.8, 0.0, 2.0, kNoNullValue, "power of point 4"},
      {"spd4", "spd4", "pu", 1.0, 0.1, 2.0, kNoNullValue, "speed at p4"},
      {"TRATE", "TRATE", "MW", 0.0, 0.0, 10000.0, kNoNullValue,
       "rating of the turbine (0: the converter's base)", kAsEffect,
       literature::own("larger than any plant")}};
  static constexpr int dyr_columns[] = {Tflag, Kpp, Kip,  Tp, Twref, Temax, Temin, p1,
                                        spd1,  p2,  spd2, p3, spd3,  p4,    spd4,  TRATE};
  enum C {
    of_power,
    kp,
    ki,
    iTp,
    iTwref,
    most,
    least,
    curve,
    base = curve + renewable::kByVoltage<>,  ///< converter base divided by the turbine rating
    pext0,
    pref,
    coefficients
  };
  enum X { power, speed, torque };
  static constexpr State states[] = {
      {"power", "pu", "measured power"},
      {"speed", "pu", "speed reference"},
      {.name = "torque", .unit = "pu", .meaning = "integral of the torque regulator", .bends = true}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_switches({Tflag});
    values.require_times({Tp, Twref});
    values.require_ranges({{Temax, Temin}});
    values.refuse_negative({Kpp, Kip, TRATE});
    values.refuse(!(p[p2] > p[p1]), values.text(p2, p1), "the powers of the speed curve must ascend",
                  "give p1 < p2 < p3 < p4");
    values.require_positive({spd1, spd2}, "a running turbine has a speed > 0");
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    c[of_power] = p[Tflag];
    c[kp] = p[Kpp];
    c[ki] = p[Kip];
    c[iTp] = inverse(p[Tp]);
    c[iTwref] = inverse(p[Twref]);
    c[most] = p[Temax];
    c[least] = p[Temin];
    renewable::prepare_by_voltage(p + p1, T(renewable::kNoLimit), c + curve);
    const auto rated = p[TRATE] > T(0.0);
    c[base] = select(rated, T(conventions.mva) / select(rated, p[TRATE], T(1.0)), T(1.0));
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T one(1.0), P = s.P * c[base];
    const T measured = lag(c[iTp], x[power], P, dx[power]);
    s.wref = lag(c[iTwref], x[speed], renewable::by_voltage(c + curve, measured), dx[speed]) - one;
    const T turning = one + s.wg;
    const T error = select(c[of_power] > T(0.5), ((c[pref] + s.Pext) * c[base] - P) / turning, s.wg - s.wref);
    const T wanted = renewable::regulator(c[kp], c[ki], error, c[least], c[most], one, x[torque], dx[torque]);
    s.Pext = wanted * turning / c[base] - c[pext0];
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    const T one(1.0);
    x[power] = s.P * c[base];
    x[speed] = renewable::by_voltage(c + curve, x[power]);
    s.wref = s.wt = s.wg = x[speed] - one;
    c[pext0] = s.Pneed;
    x[torque] = s.Pneed * c[base] / x[speed];
    c[pref] = s.Pneed = s.P;
    if (value_of(x[torque]) < value_of(c[least]) || value_of(x[torque]) > value_of(c[most]))
      return fmt::format(
          "the operating point needs a torque of {:.4f} pu, outside Temin = {:g} pu to Temax = {:g} pu",
          value_of(x[torque]), value_of(c[least]), value_of(c[most]));
    return {};
  }
};

}  // namespace swingbank::sim::effects::torque_control_wttqa1
