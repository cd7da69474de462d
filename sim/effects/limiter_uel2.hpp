#pragma once
// UEL2: under-excitation limiter with straight lines in the P-Q plane.
#include <fmt/format.h>

#include <string>
#include <utility>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/gate_power.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/renewable.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/under_excitation.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::limiter_uel2 {

struct Model {
  static constexpr std::string_view
      name = "UEL2",
      title = "under-excitation limiter with straight lines in the P-Q plane",
      source =
          "IEEE Std 421.5-2005, 10.2, type UEL2; PSS/E UEL2; OPAL-RT, UEL2.mo (columns, K1, K2, Qquad; "
          "github.com/Opal-RT-Technologies/ephasorsim-modelica-library, 45b3c3a); PowerWorld, UEL2",
      dyr_name = "UEL2";
  static constexpr Slot slot = Slot::limiter;
  static constexpr std::string_view variant_of = "UEL1";
  static constexpr std::string_view description = R"(
  V --> [ 1/(1 + s TUV) ] --> Vf        Q --> [ 1/(1 + s TUQ) ] --> Qf
  P / Vf^K1 --> [ 1/(1 + s TUP) ] --> P' --> [ through (P0, Q0) ... (P10, Q10) ] --> Q'
  Qref = Q' Vf^K2        e = Qref - Qf            above zero below the lines
  Qquad = 0: mirrored for P' < 0; 1: first line extended to P' < 0. Beyond the last point Q' is constant.
  Unused points are 0; after a negative power, (0, 0) is a point of the lines.
  d Vui/dt = KUI e within [VUIMIN, VUIMAX], non-windup
  Vui + KUL e -> (1 + s TU1)/(1 + s TU2) -> (1 + s TU3)/(1 + s TU4) -> [VULMIN, VULMAX] -> Vuel
  Vlimiter = Vlimiter + Vuel            (at the exciter's summing point; a time constant of 0: bypass)
)";
  static constexpr int kLinePoints = 11;
  using Regulator = shared::UnderExcitation<Model>;
  using Lines = shared::GatePower<kLinePoints>;
  enum P {
    K1,
    K2,
    Qquad,
    TUV,
    TUP,
    TUQ,
    KUI,
    KUL,
    VUIMAX,
    VUIMIN,
    KUF,
    KFB,
    TUL,
    TU1,
    TU2,
    TU3,
    TU4,
    P0,
    Q0,
    VULMAX = P0 + 2 * kLinePoints,
    VULMIN,
    parameter_count
  };
  static constexpr Source defaults_from = literature::cim("UnderexcLimIEEE2");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Source kUnused = literature::derived("an unused point");
  static constexpr Parameter parameters[] = {
      {"K1", "K1", "code", 2.0, 0.0, 2.0, kNoNullValue, "exponent of the voltage that divides P", kAsEffect,
       shared::kCode},
      {"K2", "K2", "code", 2.0, 0.0, 2.0, kNoNullValue, "exponent of the voltage that multiplies Q'",
       kAsEffect, shared::kCode},
      {"Qquad", "Qquad", "code", 0.0, 0.0, 1.0, kNoNullValue, "P' < 0: 0 mirrored, 1 first line extended",
       literature::derived("irrelevant for a generator"), shared::kCode},
      {"TUV", "TUV", "s", 5.0, 0.0, 60.0, kNoNullValue, "lag of the voltage (0: none)"},
      {"TUP", "TUP", "s", 5.0, 0.0, 60.0, kNoNullValue, "lag of the power (0: none)"},
      {"TUQ", "TUQ", "s", 0.0, 0.0, 60.0, kNoNullValue, "lag of the reactive power (0: none)"},
      {"KUI", "KUI", "1/s", 0.5, 0.0, 1000.0, 0.0, "integral gain"},
      {"KUL", "KUL", "pu", 0.8, 0.0, 1000.0, 0.0, "proportional gain"},
      upper_limit(
          {"VUIMAX", "VUIMAX", "pu", 0.25, 0.0, 100.0, kNoNullValue, "upper limit of the integrator"}),
      lower_limit(
          {"VUIMIN", "VUIMIN", "pu", 0.0, -100.0, 0.0, kNoNullValue, "lower limit of the integrator"}),
      {"KUF", "KUF", "pu", 0.0, 0.0, 100.0, 0.0, "gain of the exciter's rate feedback (only 0)"},
      {"KFB", "KFB", "pu", 0.0, 0.0, 100.0, 0.0, "gain of the exciter's feedback (only 0)"},
      {"TUL", "TUL", "s", 0.0, 0.0, 60.0, kNoNullValue, "lag of that feedback (no effect)"},
      {"TU1", "TU1", "s", 0.0, 0.0, 20.0, kNoNullValue, "first lead"},
      {"TU2", "TU2", "s", 0.0, 0.0, 20.0, kNoNullValue, "first lag (0: bypass)"},
      {"TU3", "TU3", "s", 0.0, 0.0, 20.0, kNoNullValue, "second lead"},
      {"TU4", "TU4", "s", 0.0, 0.0, 20.0, kNoNullValue, "second lag (0: bypass)"},
      {"P0", "P0", "pu", 0.0, -2.0, 2.0, kNoNullValue, "power of point 0"},
      lower_limit({"Q0", "Q0", "pu", -0.31, -2.0, 2.0, kNoNullValue, "least reactive power at P0"}),
      {"P1", "P1", "pu", 0.3, -2.0, 2.0, kNoNullValue, "power of point 1"},
      lower_limit({"Q1", "Q1", "pu", -0.31, -2.0, 2.0, kNoNullValue, "least reactive power at P1"}),
      {"P2", "P2", "pu", 0.6, -2.0, 2.0, kNoNullValue, "power of point 2"},
      lower_limit({"Q2", "Q2", "pu", -0.28, -2.0, 2.0, kNoNullValue, "least reactive power at P2"}),
      {"P3", "P3", "pu", 0.9, -2.0, 2.0, kNoNullValue, "power of point 3"},
      lower_limit({"Q3", "Q3", "pu", -0.21, -2.0, 2.0, kNoNullValue, "least reactive power at P3"}),
      {"P4", "P4", "pu", 1.02, -2.0, 2.0, kNoNullValue, "power of point 4"},
      lower_limit({"Q4", "Q4", "pu", 0.0, -2.0, 2.0, kNoNullValue, "least reactive power at P4"}),
      {"P5", "P5", "pu", 0.0, -2.0, 2.0, kNoNullValue, "power of point 5", kUnused},
      lower_limit({"Q5", "Q5", "pu", 0.0, -2.0, 2.0, kNoNullValue, "least reactive power at P5", kUnused}),
      {"P6", "P6", "pu", 0.0, -2.0, 2.0, kNoNullValue, "power of point 6", kUnused},
      lower_limit({"Q6", "Q6", "pu", 0.0, -2.0, 2.0, kNoNullValue, "least reactive power at P6", kUnused}),
      {"P7", "P7", "pu", 0.0, -2.0, 2.0, kNoNullValue, "power of point 7", kUnused},
      lower_limit({"Q7", "Q7", "pu", 0.0, -2.0, 2.0, kNoNullValue, "least reactive power at P7", kUnused}),
      {"P8", "P8", "pu", 0.0, -2.0, 2.0, kNoNullValue, "power of point 8", kUnused},
      lower_limit({"Q8", "Q8", "pu", 0.0, -2.0, 2.0, kNoNullValue, "least reactive power at P8", kUnused}),
      {"P9", "P9", "pu", 0.0, -2.0, 2.0, kNoNullValue, "power of point 9", kUnused},
      lower_limit({"Q9", "Q9", "pu", 0.0, -2.0, 2.0, kNoNullValue, "least reactive power at P9", kUnused}),
      {"P10", "P10", "pu", 0.0, -2.0, 2.0, kNoNullValue, "power of point 10", kUnused},
      lower_limit({"Q10", "Q10", "pu", 0.0, -2.0, 2.0, kNoNullValue, "least reactive power at P10", kUnused}),
      upper_limit({"VULMAX", "VULMAX", "pu", 0.25, 0.0, 100.0, kNoNullValue, "upper limit of the output"}),
      lower_limit(
          {"VULMIN", "VULMIN", "pu", 0.0, -100.0, 0.0, kNoNullValue, "lower limit of the output (only 0)"})};
  static constexpr auto dyr_columns = shared::columns_to<parameter_count - 1>();
  enum C {
    none_1,  ///< voltage exponent of P: 1 if K1 = 0; next two: 1 if K1 = 1, if K1 = 2
    linear_1,
    square_1,
    none_2,
    linear_2,
    square_2,
    mirrored,
    iTUV,
    iTUP,
    iTUQ,
    integral,
    proportional,
    vimax,
    vimin,
    t1,
    it2,
    t3,
    it4,
    top,
    bottom,
    last,  ///< P' of the last point [pu]
    lines,
    coefficients = lines + Lines::size
  };
  enum X { Vf, Pf, Qf, Vui, lead1, lead2 };
  static constexpr State states[] = {
      {"Vf", "pu", "voltage behind its lag"},         {"Pf", "pu", "power over voltage behind its lag"},
      {"Qf", "pu", "reactive power behind its lag"},  {"Vui", "pu", "integrator", 1.0, vimin, vimax},
      {"lead1", "pu", "state of the first lead-lag"}, {"lead2", "pu", "state of the second lead-lag"}};

  static void check(const double* p, const std::string& where, Problems& problems);
  static std::string remark(const double* p);

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    exponent(p[K1], c + none_1);
    exponent(p[K2], c + none_2);
    c[mirrored] = T(1.0) - p[Qquad];
    c[iTUV] = inverse(p[TUV]);
    c[iTUP] = inverse(p[TUP]);
    c[iTUQ] = inverse(p[TUQ]);
    Regulator::prepare(p, c);
    int power[kLinePoints], reactive[kLinePoints];
    c[last] = p[P0];
    for (int k = 0; k < kLinePoints; ++k) {
      power[k] = P0 + 2 * k;
      reactive[k] = power[k] + 1;
      c[last] = select(p[power[k]] > c[last], p[power[k]], c[last]);
    }
    Lines::prepare(p, power, reactive, c + lines);
  }
  /// Returns the deficit of Q [pu] at the lagged voltage v, and sets the derivatives of Pf and Qf in dx.
  template <class T>
  static T missing(const T* c, const T* x, const Signals<T>& s, const T& v, T* dx) {
    const T over = power_of(c + none_1, renewable::at_least_small(v));
    const T p = lag(c[iTUP], x[Pf], s.P / over, dx[Pf]), q = lag(c[iTUQ], x[Qf], s.Q, dx[Qf]);
    const T right = select(c[mirrored] > T(0.0), select(p < T(0.0), T(0.0) - p, p), p);
    const T at = select(right < c[last], right, c[last]);
    return Lines::value(c + lines, at) * power_of(c + none_2, v) - q;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T v = lag(c[iTUV], x[Vf], s.V, dx[Vf]);
    s.Vlimiter = s.Vlimiter + Regulator::output(c, x, missing(c, x, s, v, dx), dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    x[Vf] = s.V;
    x[Pf] = s.P / power_of(c + none_1, renewable::at_least_small(s.V));
    x[Qf] = s.Q;
    T dx[std::size(states)];
    const T e = missing(c, x, s, s.V, dx);
    if (value_of(e) > 0.0)
      return fmt::format(
          "P = {:.4f} pu, Q = {:.4f} pu at V = {:.4f} pu lies {:.4f} pu below the lines: UEL2 would act "
          "from the start",
          value_of(s.P), value_of(s.Q), value_of(s.V), value_of(e));
    Regulator::rest(p, e, x);
    evaluate(c, x, s, dx);
    return {};
  }

 private:
  template <class T>
  static void exponent(const T& k, T* c) {
    for (int i = 0; i < 3; ++i) {
      const T off = k - T(static_cast<double>(i));
      c[i] = select(off * off < T(0.25), T(1.0), T(0.0));
    }
  }
  template <class T>
  static T power_of(const T* c, const T& v) {
    return c[0] + v * (c[1] + v * c[2]);
  }
};

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(name, parameters, p, where, problems);
  for (int i : {K1, K2})
    values.refuse(p[i] != 0.0 && p[i] != 1.0 && p[i] != 2.0, i, "it is an exponent of the voltage",
                  "give 0, 1 or 2");
  values.refuse(p[Qquad] != 0.0 && p[Qquad] != 1.0, Qquad, "it selects the characteristic for P' < 0",
                "give 0 or 1");
  values.require_times({TUV, TUP, TUQ, TUL});
  values.refuse(p[KFB] != 0.0, KFB, "the exciter's feedback is not passed to UEL2", "give KFB = 0");
  Regulator::check(p, where, problems);
  values.refuse(!(p[P0 + 2] > p[P0]), values.text(P0, P0 + 2), "the limit is a line through two points",
                "give P0 < P1");
  for (int k = 2; k < kLinePoints; ++k) {
    const int here = P0 + 2 * k;
    const bool ends = !(p[here] > p[here - 2]), unused = p[here] == 0.0 && p[here + 1] == 0.0;
    values.refuse(ends && !unused, values.text(here, here + 1),
                  "the power must exceed that of the preceding point",
                  "give points in ascending order of the power, unused ones as 0");
    values.refuse(k + 1 < kLinePoints && ends && unused && (p[here + 2] != 0.0 || p[here + 3] != 0.0),
                  values.text(here + 2, here + 3), "a point follows the end of the lines",
                  "give points in ascending order of the power, unused ones as 0");
  }
}
inline std::string Model::remark(const double* p) {
  int end = P0;
  for (int k = 1; k < kLinePoints && p[P0 + 2 * k] > p[end]; ++k) end = P0 + 2 * k;
  if (p[end + 1] == 0.0) return {};
  return fmt::format(
      "beyond its last point, P' = {:g} pu, the least reactive power stays {:g} pu; in OPAL-RT's UEL2 it "
      "goes to 0 there",
      p[end], p[end + 1]);
}

}  // namespace swingbank::sim::effects::limiter_uel2
