#pragma once
// Common part of the hydro governors WSHYGP and HYG3: PID regulator with an input filter and optional droop
// feedback, gate servo with backlash, points of the gate's curve.
#include <array>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

inline constexpr double kLeastRating = 1e-3;  ///< smaller turbine ratings mean "not given" [MW]
/// Returns the base of a turbine's gate and power: its rating, or the machine base if not given [MVA].
template <class T>
T turbine_rating(const T& given, const Conventions& conventions) {
  return select(given > T(kLeastRating), given, T(conventions.mva));
}

inline constexpr Source kFarPoint = literature::own("99 marks a point that is never reached");
constexpr Parameter curve_point(std::string_view name, std::string_view meaning) {
  return {name, name, "pu", 0.0, 0.0, 99.0, kNoNullValue, meaning, kAsEffect, kFarPoint};
}
/// Openings and powers of the points of a gate's curve: HYG3 uses all six points, WSHYGP the first five.
inline constexpr std::array kCurvePoints = {curve_point("GV1", "first opening (all 0: no curve)"),
                                            curve_point("PGV1", "power at GV1"),
                                            curve_point("GV2", "second opening"),
                                            curve_point("PGV2", "power at GV2"),
                                            curve_point("GV3", "third opening"),
                                            curve_point("PGV3", "power at GV3"),
                                            curve_point("GV4", "fourth opening"),
                                            curve_point("PGV4", "power at GV4"),
                                            curve_point("GV5", "fifth opening"),
                                            curve_point("PGV5", "power at GV5"),
                                            curve_point("GV6", "sixth opening"),
                                            curve_point("PGV6", "power at GV6")};

/// Gate servo with backlash. A Model has the coefficients servo, iTP, opening, closing, high, low, play and
/// follow, and the states velocity, gate and position.
template <class Model>
struct GateServo {
  using M = Model;
  static constexpr State velocity_state(int iTP, int closing, int opening) {
    return {"velocity", "pu/s", "gate's velocity", 1.0, closing, opening, {iTP}};
  }
  static constexpr State gate_state(int low, int high) {
    return {.name = "gate", .unit = "pu", .meaning = "gate opening", .low = low, .high = high, .bends = true};
  }
  static constexpr State position_state(int follow) {
    return {.name = "position",
            .unit = "pu",
            .meaning = "gate behind its backlash",
            .moved_by = {follow},
            .bends = true};
  }
  /// Returns the gate's effective position, after the backlash [pu].
  template <class T>
  static T evaluate(const T* c, const T* x, const T& cv, T* dx) {
    const T open = clamp(x[M::gate], c[M::low], c[M::high]);
    dx[M::position] = c[M::follow] * dead_band(open - x[M::position], c[M::play]);
    const T gv = select(c[M::follow] > T(0.0), x[M::position], open);
    dx[M::gate] = clamp(lag(c[M::iTP], x[M::velocity], c[M::servo] * (cv - gv), dx[M::velocity]),
                        c[M::closing], c[M::opening]);
    return gv;
  }
};

/// PID regulator with input filter: u/(1 + s TD) --> KP + KI/s + s KD/(1 + s TF). Its states and coefficients
/// must precede all others of a Model.
struct HydroPid {
  enum C { iTD, kp, ki, kd, iTF, coefficients };  ///< kd: KD/TF
  enum X { filtered, integral, lagged, count };
  static constexpr std::array<State, count> states = {
      State{"filtered", "pu", "filtered error", 1.0, -1, -1, {iTD}},
      State{"integral", "pu", "integral of the error", 1.0, -1, -1, {ki}},
      State{"lagged", "pu", "error behind the derivative's lag", 1.0, -1, -1, {iTF}}};

  template <class T>
  static void prepare(const T& TD, const T& KP, const T& KI, const T& KD, const T& TF, T* c) {
    c[iTD] = inverse(TD);
    c[kp] = KP;
    c[ki] = KI;
    c[iTF] = inverse(TF);
    c[kd] = KD * c[iTF];
  }
  /// Returns the output for the input `u - back * output`, where `back` is the droop. Without the filter this
  /// is an algebraic loop, which is solved in closed form.
  template <class T>
  static T evaluate(const T* c, const T* x, const T& u, const T& back, T* dx) {
    const T rest = x[integral] - c[kd] * x[lagged], share = c[kp] + c[kd];
    const auto filters = c[iTD] > T(0.0);
    const T error = select(filters, x[filtered], (u - back * rest) / (T(1.0) + back * share));
    const T out = rest + share * error;
    dx[filtered] = (u - back * out - x[filtered]) * c[iTD];
    dx[integral] = c[ki] * error;
    dx[lagged] = (error - x[lagged]) * c[iTF];
    return out;
  }
  /// Computes the states for a steady output. Returns the steady error, which is 0 with an integral gain.
  template <class T>
  static T steady(const T* c, const T& out, T* x) {
    const T zero(0.0);
    const auto integrates = c[ki] > zero;
    const T error = select(integrates, zero, out / select(integrates, T(1.0), c[kp]));
    x[integral] = select(integrates, out, zero);
    x[filtered] = x[lagged] = error;
    return error;
  }
  /// Checks the gains; `ikp` to `itf`: their parameters, for messages.
  static void check(const ValueCheck& values, int ikp, double KP, int iki, double KI, int ikd, double KD,
                    int itf, double TF) {
    values.refuse(!(KI > 0) && !(KP > 0), values.text(iki, ikp), "no gate position would be steady",
                  "give an integral or a proportional gain > 0");
    values.refuse(!(TF >= 0) || (KD > 0 && TF == 0), values.text(ikd, itf), "a derivative needs a lag",
                  "give a time constant > 0, or a derivative gain of 0");
  }
};

}  // namespace swingbank::sim::effects::shared
