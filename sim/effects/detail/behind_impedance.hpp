#pragma once
// Common part of the converters behind an impedance REGCB1 and REGCC1: parameters, current commands with Imax
// and lags, current through the impedance.
#include <cmath>
#include <string>
#include <utility>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/controlled_current.hpp"
#include "sim/effects/detail/electrical_control.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

/// A Model must enumerate the parameters below (kTg as Tg, and so on), Te and Tfreq. It must also have the
/// coefficients that prepare_common() fills, and the states Ip, Iq, Vf, Vrlag and Vilag.
template <class Model>
struct BehindImpedance : ControlledCurrent<Model> {
  static constexpr Source defaults_from = literature::own("as REGCA1's");
  static constexpr Source bounds_from = renewable::kWecc;
  static constexpr Parameter kRateFlag{"rateFlag",   "rateFlag",
                                       "code",       0.0,
                                       0.0,          1.0,
                                       kNoNullValue, "limited by rrpwr: 0 active current, 1 power",
                                       kAsEffect,    renewable::kFlag};
  static constexpr Parameter kPqFlag{
      "pqFlag",  "pqFlag",        "code", 0.0, 0.0, 1.0, kNoNullValue, "current priority at Imax: 0 Q, 1 P",
      kAsEffect, renewable::kFlag};
  static constexpr Parameter kTg{"Tg", "Tg", "s",          0.02,
                                 1e-3, 0.5,  kNoNullValue, "time constant of the converter"};
  static constexpr Parameter kTfltr{
      "Tfltr", "Tfltr", "s",          0.2,
      0.0,     1.0,     kNoNullValue, "lag of the voltage measurement for rateFlag 1 (0: none)"};
  static constexpr Parameter kIqrmax{
      "Iqrmax", "Iqrmax", "pu/s", 100.0, 0.0, 9999.0, kNoNullValue, "fastest rise of the reactive current"};
  static constexpr Parameter kIqrmin{
      "Iqrmin", "Iqrmin", "pu/s", -100.0, -9999.0, 0.0, kNoNullValue, "fastest fall of the reactive current"};
  static constexpr Parameter kRrpwr{
      "rrpwr", "rrpwr", "pu/s",       10.0,
      0.01,    999.0,   kNoNullValue, "fastest rise of the active current or power"};
  static constexpr Parameter kImax =
      upper_limit({"Imax", "Imax", "pu", 1.3, 0.1, 99.0, kNoNullValue, "largest current"});
  static constexpr Parameter kRe{"Re",      "Re", "pu", 0.0, 0.0, 0.5, kNoNullValue, "source resistance",
                                 kNeglected};
  static constexpr Parameter kXe{"Xe",
                                 "Xe",
                                 "pu",
                                 0.25,
                                 0.01,
                                 2.0,
                                 kNoNullValue,
                                 "source reactance",
                                 literature::own("InterPSS's for aggregated converters")};
  /// Fraction of Imax. Where the circle Ip^2 + Iq^2 = Imax^2 limits the current without priority to less than
  /// this fraction, a tangent replaces the circle.
  static constexpr double kTangent = 0.05;

 protected:
  static void check_common(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(Model::name, Model::parameters, p, where, problems);
    values.require_switches({Model::rateFlag, Model::pqFlag});
    values.require_times({Model::Tfltr, Model::Te});
    values.refuse_negative({Model::Iqrmax, Model::Re});
    values.refuse_positive({Model::Iqrmin});
    values.require_positive({Model::Tg, Model::rrpwr, Model::Imax, Model::Xe, Model::Tfreq},
                            "the equations divide by it, or the current could not change");
  }
  template <class T>
  static void prepare_common(const T* p, const Conventions& conventions, T* c) {
    for (const auto& [to, from] : {std::pair<int, int>{Model::of_power, Model::rateFlag},
                                   {Model::p_first, Model::pqFlag},
                                   {Model::q_rise, Model::Iqrmax},
                                   {Model::q_fall, Model::Iqrmin},
                                   {Model::rise, Model::rrpwr},
                                   {Model::most, Model::Imax},
                                   {Model::r, Model::Re},
                                   {Model::x_e, Model::Xe}})
      c[to] = p[from];
    for (const auto& [to, from] :
         {std::pair<int, int>{Model::iTg, Model::Tg}, {Model::iTfltr, Model::Tfltr}, {Model::iTe, Model::Te}})
      c[to] = inverse(p[from]);
    c[Model::admittance] = T(1.0) / (p[Model::Re] * p[Model::Re] + p[Model::Xe] * p[Model::Xe]);
    ControlledCurrent<Model>::prepare_frequency(p[Model::Tfreq], conventions, c);
  }
  /// Returns the lagged active current [pu].
  template <class T>
  static T lagged_active(const T* c, const T* x, const T& V) {
    const T measured = renewable::at_least_small(select(c[Model::iTfltr] > T(0.0), x[Model::Vf], V));
    return select(c[Model::of_power] > T(0.5), x[Model::Ip] / measured, x[Model::Ip]);
  }
  /// Adds the voltage drop of the currents across the impedance to the voltage d + jq [pu].
  template <class T>
  static void add_drop(const T* c, const T& active, const T& reactive, T& d, T& q) {
    d = d + c[Model::r] * active + c[Model::x_e] * reactive;
    q = q + c[Model::x_e] * active - c[Model::r] * reactive;
  }
  /// Computes the currents that the voltage d + jq drives through the impedance, before the limit Imax [pu].
  template <class T>
  static void impedance_currents(const T* c, const T& d, const T& q, T& active, T& reactive) {
    active = (c[Model::r] * d + c[Model::x_e] * q) * c[Model::admittance];
    reactive = (c[Model::x_e] * d - c[Model::r] * q) * c[Model::admittance];
  }
  /// Passes the steps of the references to the controls, and the power at the operating point to a drive
  /// train without aerodynamics.
  template <class T>
  static void pass_references(const T* c, Signals<T>& s) {
    s.Pext = s.dPref;
    s.Qext = s.dVref;
    s.Paero = c[Model::start];
  }
  template <class T>
  static void follow_commands(const T* c, const T* x, const T& magnitude, const Signals<T>& s, T* dx) {
    const T V = lag(c[Model::iTfltr], x[Model::Vf], magnitude, dx[Model::Vf]);
    T p = s.Tm, q = s.Efd;
    within(c, p, q);
    const T wanted = (select(c[Model::of_power] > T(0.5), p * V, p) - x[Model::Ip]) * c[Model::iTg],
            none(renewable::kNoLimit);
    const auto draws = x[Model::Ip] < T(0.0);
    dx[Model::Ip] = clamp(wanted, select(draws, T(0.0) - c[Model::rise], T(0.0) - none),
                          select(draws, none, c[Model::rise]));
    dx[Model::Iq] = clamp((q - x[Model::Iq]) * c[Model::iTg], c[Model::q_fall], c[Model::q_rise]);
  }
  /// Initialises the commands and their lags. p, q: active and reactive current at the voltage V [pu].
  /// Returns the reason if the operating point is infeasible, or "".
  template <class T>
  static std::string steady_commands(T* c, const T& V, T& p, T& q, Signals<T>& s, T* x) {
    const T P = s.Vr * s.Ir + s.Vi * s.Ii, Q = s.Vi * s.Ir - s.Vr * s.Ii;
    p = P / V;
    q = Q / V;
    const double active = value_of(p), reactive = value_of(q), total = value_of(c[Model::most]);
    if (active * active + reactive * reactive > total * total)
      return renewable::beyond_imax(active, reactive, total);
    x[Model::Vf] = V;
    x[Model::Ip] = select(c[Model::of_power] > T(0.5), P, p);
    x[Model::Iq] = q;
    if (!(value_of(Q) > 0.0)) c[Model::q_rise] = T(renewable::kNoLimit);
    if (!(value_of(Q) < 0.0)) c[Model::q_fall] = T(-renewable::kNoLimit);
    ControlledCurrent<Model>::steady_voltage(s, x);
    c[Model::start] = P;
    s.Tm = p;
    s.Efd = q;
    s.V = V;
    return {};
  }
  /// Returns the limit of the current without priority; `leading`: the current with priority [pu].
  template <class T>
  static T left(const T* c, const T& leading) {
    using std::sqrt;
    const T square = c[Model::most] * c[Model::most] - leading * leading, knee = T(kTangent) * c[Model::most];
    const auto on_circle = square > knee * knee;
    return select(on_circle, sqrt(select(on_circle, square, T(1.0))), (square + knee * knee) / (knee + knee));
  }
  /// Computes the limits of both currents; the limit of the current with priority is Imax [pu].
  template <class T>
  static void limits(const T* c, const T& p, const T& q, T& most_p, T& most_q) {
    const auto p_leads = c[Model::p_first] > T(0.5);
    const T second_limit = left(c, clamp(select(p_leads, p, q), T(0.0) - c[Model::most], c[Model::most]));
    most_p = select(p_leads, c[Model::most], second_limit);
    most_q = select(p_leads, second_limit, c[Model::most]);
  }
  /// Limits both currents to Imax; the flag pqFlag selects the current with priority.
  template <class T>
  static void within(const T* c, T& p, T& q) {
    T most_p, most_q;
    limits(c, p, q, most_p, most_q);
    p = clamp(p, T(0.0) - most_p, most_p);
    q = clamp(q, T(0.0) - most_q, most_q);
  }
};

}  // namespace swingbank::sim::effects::shared
