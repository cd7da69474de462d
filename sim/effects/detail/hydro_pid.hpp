#pragma once
// The PID regulator of the hydro governors WSHYGP and HYG3, behind a filter of its input, which may be fed
// back through a droop without a lag.
#include <array>
#include <string>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::effects::shared {

inline constexpr double kLeastRating = 1e-3;  ///< of a turbine: less is none given [MW]
/// The base of a turbine's gate and power, the machine's where none is given [MVA].
template <class T>
T turbine_rating(const T& given, const Conventions& conventions) {
  return select(given > T(kLeastRating), given, T(conventions.mva));
}

/// u/(1 + s TD) --> KP + KI/s + s KD/(1 + s TF). States and coefficients are the first of its Model.
struct HydroPid {
  enum C { iTD, kp, ki, kd, iTF, coefficients };  ///< kd: KD/TF
  enum X { filtered, integral, lagged, count };
  static constexpr std::array<State, count> states = {
      State{"filtered", "pu", "filtered error", 1.0, -1, -1, {iTD}},
      State{"integral", "pu", "integral of the error", 1.0, -1, -1, {ki}},
      State{"lagged", "pu", "error, lagged by the derivative", 1.0, -1, -1, {iTF}}};

  template <class T>
  static void prepare(const T& TD, const T& KP, const T& KI, const T& KD, const T& TF, T* c) {
    c[iTD] = inverse(TD);
    c[kp] = KP;
    c[ki] = KI;
    c[iTF] = inverse(TF);
    c[kd] = KD * c[iTF];
  }
  /// The output for the input `u - back * output`; without the filter that is solved for.
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
  /// States for a resting output; returns the error that holds it, which is 0 where it is integrated.
  template <class T>
  static T steady(const T* c, const T& out, T* x) {
    const T zero(0.0);
    const auto integrates = c[ki] > zero;
    const T error = select(integrates, zero, out / select(integrates, T(1.0), c[kp]));
    x[integral] = select(integrates, out, zero);
    x[filtered] = x[lagged] = error;
    return error;
  }
  static void check(const std::string& says_kp, double KP, const std::string& says_ki, double KI,
                    const std::string& says_kd, double KD, const std::string& says_tf, double TF,
                    const std::string& where, Problems& problems) {
    if (!(KI > 0) && !(KP > 0))
      problems.add(says_ki + " with " + says_kp, where, "no gate could be held",
                   "give an integral or a proportional gain > 0");
    if (!(TF >= 0) || (KD > 0 && TF == 0))
      problems.add(says_kd + " with " + says_tf, where, "no derivative without a lag",
                   "give a washout > 0, or no derivative gain");
  }
};

}  // namespace swingbank::sim::effects::shared
