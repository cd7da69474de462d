#pragma once
// Woodward's governor of a diesel engine: control box, actuator and engine of DEGOV and DEGOV1. A Model
// appends its coefficients and states and defines the control box's input, asked(c, x, s, dx).

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

template <class Model>
struct Diesel {
  static constexpr Slot slot = Slot::governor;
  static constexpr Source defaults_from =
      literature::own("within PSS/E's usual ranges; no published sample was found");
  static constexpr Source bounds_from = kNoCases;
  static constexpr Parameter
      kT1 = {"T1", "T1",  "s",          0.01,
             0.0,  100.0, kNoNullValue, "control box, first time constant (0: neither lag nor lead)"},
      kT2 = {"T2", "T2", "s", 0.02, 0.0, 100.0, kNoNullValue, "control box, second time constant"},
      kT3 = {"T3", "T3", "s", 0.2, 0.0, 100.0, kNoNullValue, "control box, lead"},
      kK = {"K",
            "K",
            "1/s",
            18.0,
            0.1,
            1000.0,
            kNoNullValue,
            "actuator's gain",
            literature::psid("DEGOV/ThreeBus_DEGOV_nodelay.dyr")},
      kT4 = {"T4", "T4", "s", 0.25, 0.0, 100.0, kNoNullValue, "actuator's lead"},
      kT5 = {"T5", "T5",  "s",          0.01,
             0.0,  100.0, kNoNullValue, "actuator, first lag (0: neither lag nor lead)"},
      kT6 = {"T6", "T6", "s", 0.01, 0.0, 100.0, kNoNullValue, "actuator, second lag (0: none)"},
      kTD = {"TD", "TD", "s", 0.024, 0.0, 5.0, 0.0, "combustion delay (0: none)"},
      kTMAX =
          upper_limit({"TMAX", "TMAX", "pu", 1.1, 0.1, 10.0, kNoNullValue, "upper limit of the throttle"}),
      kTMIN =
          lower_limit({"TMIN", "TMIN", "pu", 0.0, -1.0, 1.0, kNoNullValue, "lower limit of the throttle"});
  /// Order of the delay's Pade approximation: exp(-s TD) as a ratio of polynomials of orders 3 and 4. Its
  /// error is at most 1e-3 up to s TD = 2.5j, and it has no direct feedthrough.
  static constexpr int kDelayOrder = 4;
  enum C { iTb, iT1, box_lead, gain, t4, iT5, iT6, high, low, iTD, own };
  enum X { box, box_rate, integral, lead, throttle, delay, own_states = delay + kDelayOrder };
  static constexpr std::array<State, own_states> kStates = {{
      {"box", "pu", "control box", 1.0, -1, -1, {iT1, iTb}},
      {"box_rate", "pu/s", "derivative of the control box's output", 0.01, -1, -1, {iTb}},
      {"integral", "pu", "actuator's integral", 1.0, low, high},
      {"lead", "pu", "state of the actuator's lead-lag", 1.0, -1, -1, {iT5}},
      {"throttle", "pu", "throttle", 1.0, low, high},
      {"delay1", "pu", "delay, first state", 1.0, -1, -1, {iTD}},
      {"delay2", "pu", "delay, second state", 1.0, -1, -1, {iTD}},
      {"delay3", "pu", "delay, third state", 1.0, -1, -1, {iTD}},
      {"delay4", "pu", "delay, fourth state", 1.0, -1, -1, {iTD}},
  }};

  static void check(const double* p, const std::string& where, Problems& problems) {
    using M = Model;
    const shared::ValueCheck values(M::name, M::parameters, p, where, problems);
    values.require_positive({M::K}, "the output would be constant");
    values.refuse_negative({M::T1, M::T2, M::T3, M::T4, M::T5, M::T6, M::TD}, "a time cannot be negative");
    values.refuse(p[M::T1] == 0 && (p[M::T2] != 0 || p[M::T3] != 0), values.text(M::T1, M::T2, M::T3),
                  "the control box is then bypassed", "give T2 = T3 = 0 with T1 = 0");
    values.require_above(M::TMAX, M::TMIN, "the range of the throttle must not be empty");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    using M = Model;
    c[iT1] = inverse(p[M::T1]);
    c[iTb] = c[iT1] * inverse(p[M::T2]);
    c[box_lead] = p[M::T3];
    c[gain] = p[M::K];
    c[t4] = p[M::T4];
    c[iT5] = inverse(p[M::T5]);
    c[iT6] = inverse(p[M::T6]);
    c[high] = p[M::TMAX];
    c[low] = p[M::TMIN];
    c[iTD] = inverse(p[M::TD]);
  }
  /// Evaluates the control box (1 + s T3)/(1 + s T1 + s^2 T1 T2): second order, first order for T2 = 0, the
  /// input for T1 = 0.
  template <class T>
  static T control_box(const T* c, const T* x, const T& u, T* dx) {
    const T zero(0.0);
    const auto second = c[iTb] > zero, first = c[iT1] > zero;
    const T derivative = (u - x[box]) * c[iT1];
    dx[box] = select(second, x[box_rate], derivative);
    dx[box_rate] =
        (u - x[box]) * c[iTb] - select(second, c[iTb] / select(first, c[iT1], T(1.0)), zero) * x[box_rate];
    return select(first, x[box] + c[box_lead] * dx[box], u);
  }
  /// Evaluates the delay exp(-s TD); TD = 0 passes the input. Controllable canonical form, scaled by TD, of
  /// (840 - 360 z + 60 z^2 - 4 z^3)/(840 + 480 z + 120 z^2 + 16 z^3 + z^4), z = s TD.
  template <class T>
  static T delayed(const T* c, const T* x, const T& u, T* dx) {
    const T* z = x + delay;
    for (int i = 0; i + 1 < kDelayOrder; ++i) dx[delay + i] = z[i + 1] * c[iTD];
    dx[delay + kDelayOrder - 1] =
        (T(840.0) * (u - z[0]) - T(480.0) * z[1] - T(120.0) * z[2] - T(16.0) * z[3]) * c[iTD];
    const T late = z[0] + (T(60.0) * z[2] - T(360.0) * z[1] - T(4.0) * z[3]) * T(1.0 / 840.0);
    return select(c[iTD] > T(0.0), late, u);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T y = control_box(c, x, Model::asked(c, x, s, dx), dx);
    dx[integral] = c[gain] * y;
    const T sum = clamp(x[integral], c[low], c[high]);
    // The lead acts on the integral: (1 + s T4)/(s (1 + s T5)).
    const T u = lead_lag(c[t4], c[iT5], x[lead], sum, dx[lead]);
    const T opening = clamp(lag(c[iT6], x[throttle], u, dx[throttle]), c[low], c[high]);
    s.Tm = delayed(c, x, opening, dx) * (T(1.0) + s.speed);
  }
  template <class T>
  static std::string steady_engine(Signals<T>& s, T* x) {
    for (int i = 0; i < own_states; ++i) x[i] = T(0.0);
    x[integral] = x[lead] = x[throttle] = x[delay] = s.Tm;
    return {};
  }
};

}  // namespace swingbank::sim::effects::shared
