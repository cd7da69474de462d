#pragma once
// IEEEST: power system stabiliser of the IEEE (1981).

#include <cmath>

#include "sim/core/blocks.hpp"
#include "sim/core/bus_frequency.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::stabiliser_ieeest {

struct Model {
  static constexpr std::string_view name = "IEEEST", title = "IEEE power system stabiliser of 1981",
                                    source =
                                        "IEEE Committee Report, Excitation system models (1981); "
                                        "PSS/E IEEEST",
                                    dyr_name = "IEEEST";
  static constexpr Slot slot = Slot::stabiliser;
  static constexpr std::string_view description = R"(
        (1 + A5 s + A6 s^2)              1 + s T1   1 + s T3      s T5
  u -> ------------------------------- -> -------- - -------- KS -------- -> [LSMIN, LSMAX] -> Vs
       (1+A1 s+A2 s^2)(1+A3 s+A4 s^2)    1 + s T2   1 + s T4     1 + s T6
  u: speed deviation (ICS = 1), frequency deviation of the terminal (2), electrical power on the machine's
     base (3), accelerating power Pm - P (4), voltage V (5), its derivative (6).
     Frequency from the voltage and the lagged voltage x = V/(1 + s Tf): Im(V conj x)/(|V| |x|)/(2 pi f0 Tf);
     derivative s V/(1 + s Tf).
  Vs = 0 while Vc > VCU or Vc < VCL (a zero switches that side off). T2, T4 = 0: bypass; T6 = 0: KS alone.
)";
  enum P { ICS, IB, A1, A2, A3, A4, A5, A6, T1, T2, T3, T4, T5, T6, KS, LSMAX, LSMIN, VCU, VCL, Tf };
  static constexpr Source kCase = literature::psid("IEEEST/ThreeBus_IEEEST.dyr");
  static constexpr Source defaults_from =
      literature::own("speed input, two equal leads of ratio five; no published sample was found");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"ICS", "ICS", "code", 1.0, 1.0, 6.0, kNoNullValue,
       "input: 1 speed, 2 frequency, 3 electrical, 4 accelerating power, 5 voltage, 6 derivative of the voltage",
       kCase, literature::sienna("IEEEST")},
      {"IB", "IB", "code", 0.0, 0.0, 999997.0, kNoNullValue, "remote bus (0: the machine's own)", kCase,
       shared::kBusNumber},
      {"A1", "A1", "s", 0.06, 0.0, 10.0, 0.0, "filter denominator 1, first order",
       literature::own("near CIM's PSS1A, 0.061 and 0.0017")},
      {"A2", "A2", "s^2", 0.0016, 0.0, 10.0, 0.0, "filter denominator 1, second order",
       literature::own("near CIM's PSS1A, 0.061 and 0.0017")},
      {"A3", "A3", "s", 0.03, 0.0, 10.0, 0.0, "filter denominator 2, first order"},
      {"A4", "A4", "s^2", 0.0004, 0.0, 10.0, 0.0, "filter denominator 2, second order"},
      {"A5", "A5", "s", 0.0, -10.0, 10.0, 0.0, "filter numerator, first order", kCase},
      {"A6", "A6", "s^2", 0.0, -10.0, 10.0, 0.0, "filter numerator, second order", kCase},
      {"T1", "T1", "s", 0.1, 0.0, 20.0, kNoNullValue, "first lead"},
      {"T2", "T2", "s", 0.02, 0.0, 20.0, kNoNullValue, "first lag (0: bypass)"},
      {"T3", "T3", "s", 0.1, 0.0, 20.0, kNoNullValue, "second lead"},
      {"T4", "T4", "s", 0.02, 0.0, 20.0, kNoNullValue, "second lag (0: bypass)"},
      {"T5", "T5", "s", 5.0, 0.0, 50.0, kNoNullValue, "washout numerator"},
      {"T6", "T6", "s", 5.0, 0.0, 50.0, kNoNullValue, "washout denominator (0: bypass)"},
      {"KS", "KS", "pu", 10.0, -1000.0, 1000.0, 0.0, "gain"},
      upper_limit({"LSMAX", "LSMAX", "pu", 0.1, 0.0, 10.0, kNoNullValue, "upper limit of Vs", kCase}),
      lower_limit({"LSMIN", "LSMIN", "pu", -0.1, -10.0, 0.0, kNoNullValue, "lower limit of Vs", kCase}),
      {"VCU", "VCU", "pu", 1.25, 0.0, 10.0, 0.0, "no output above this voltage (0: off)",
       literature::sienna("IEEEST, largest value")},
      {"VCL", "VCL", "pu", 0.7, -10.0, 1.0, 0.0, "no output below this voltage (0: off)"},
      {"Tf", "Tf", "s", 0.04, 0.005, 1.0, kNoNullValue, "lag of the frequency or derivative measurement",
       literature::own("two and a half cycles of 60 Hz"),
       literature::own("from a quarter of a cycle of 50 Hz to a second")}};
  static constexpr int dyr_columns[] = {ICS, IB, A1, A2, A3, A4,    A5,    A6,  T1, T2,
                                        T3,  T4, T5, T6, KS, LSMAX, LSMIN, VCU, VCL};
  enum C {
    w1,
    w2,
    w3,
    w4,
    w5,
    w6,
    iTf,
    per_lead,
    a1,
    a2,
    a3,
    a4,
    a5,
    a6,
    ia1,
    ia2,
    ia3,
    ia4,
    t1,
    it2,
    t3,
    it4,
    wash,
    it6,
    gain,
    low,
    high,
    vcu,
    vcl,
    sharp,
    coefficients
  };
  enum X { y, ydot, w, wdot, lead1, lead2, washed, xr, xi };
  // An error of a derivative state decays within the filter's time constant, so its weight is a typical time
  // constant. A numerator amplifies the filter's errors by the coefficient `sharp`.
  static constexpr State states[] = {
      {.name = "y",
       .unit = "pu",
       .meaning = "first filter's output",
       .moved_by = {ia1, ia2},
       .weighed_by = sharp},
      {.name = "ydot",
       .unit = "pu/s",
       .meaning = "derivative of y",
       .weight = 0.05,
       .moved_by = {ia2},
       .weighed_by = sharp},
      {.name = "w",
       .unit = "pu",
       .meaning = "second filter's state",
       .moved_by = {ia3, ia4},
       .weighed_by = sharp},
      {.name = "wdot",
       .unit = "pu/s",
       .meaning = "derivative of w",
       .weight = 0.05,
       .moved_by = {ia4},
       .weighed_by = sharp},
      {.name = "lead1", .unit = "pu", .meaning = "state of the first lead-lag", .moved_by = {it2}},
      {.name = "lead2", .unit = "pu", .meaning = "state of the second lead-lag", .moved_by = {it4}},
      {.name = "washed", .unit = "pu", .meaning = "state of the washout", .moved_by = {it6}},
      {.name = "xr",
       .unit = "pu",
       .meaning = "lagged voltage, real (ICS = 6: magnitude)",
       .moved_by = {w2, w6}},
      {.name = "xi", .unit = "pu", .meaning = "lagged voltage, imaginary", .moved_by = {w2}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.refuse(!(p[ICS] >= 1.0 && p[ICS] <= 6.0 && p[ICS] == std::floor(p[ICS])), ICS,
                  "IEEEST reads speed (1), frequency (2), electrical power (3), "
                  "accelerating power (4), voltage (5) or its derivative (6)",
                  "give a whole number from 1 to 6");
    values.require_time(Tf, p[KS] != 0 && (p[ICS] == 2.0 || p[ICS] == 6.0),
                        "ICS other than 2 and 6 or KS = 0");
    values.require_finite({Tf});
    // Speed and powers are those of the machine itself, whatever the bus number.
    values.refuse(p[IB] != 0.0 && p[ICS] != 1.0 && p[ICS] != 3.0 && p[ICS] != 4.0, IB,
                  "IEEEST measures only its own machine", "give IB = 0");
    values.refuse_negative({A1, A2, A3, A4}, "the filter would be unstable");
    values.require_times({T2, T4, T6});
    const auto order = [](double first, double second) { return second != 0.0 ? 2 : first != 0.0 ? 1 : 0; };
    values.refuse(order(p[A5], p[A6]) > order(p[A1], p[A2]) + order(p[A3], p[A4]), values.text(A5, A6),
                  "the filter would differentiate: its numerator is of higher order than its denominator",
                  "give more of A1 to A4 > 0");
    values.require_ranges({{LSMAX, LSMIN}});
  }
  /// A cut-off within the band of normal voltages would switch the stabiliser on and off continually.
  static std::string_view unphysical(const double* p) {
    if (p[VCU] > 0.0 && p[VCU] < 1.1) return "VCU >= 1.1";
    if (p[VCL] > 0.9) return "VCL <= 0.9";
    return "";
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    const T zero(0.0), one(1.0);
    const auto is = [&](double code) {
      return select(p[ICS] > T(code - 0.5), select(p[ICS] < T(code + 0.5), one, zero), zero);
    };
    c[w1] = is(1);
    c[w2] = is(2);
    c[w3] = is(3);
    c[w4] = is(4);
    c[w5] = is(5);
    c[w6] = is(6);
    c[iTf] = inverse(p[Tf]);
    c[per_lead] = c[w2] * frequency_per_angle(c[iTf], conventions.frequency);
    for (int i = 0; i < 6; ++i) c[a1 + i] = p[A1 + i];
    for (int i = 0; i < 4; ++i) c[ia1 + i] = inverse(p[A1 + i]);
    c[t1] = p[T1];
    c[it2] = inverse(p[T2]);
    c[t3] = p[T3];
    c[it4] = inverse(p[T4]);
    c[it6] = inverse(p[T6]);
    c[wash] = p[KS] * p[T5] * c[it6];
    c[gain] = p[KS];
    c[low] = p[LSMIN];
    c[high] = p[LSMAX];
    const auto size = [&](const T& a) { return positive_part(a) + positive_part(zero - a); };
    c[sharp] = one + size(c[a5]) * (c[ia1] + c[ia3]) + size(c[a6]) * (c[ia2] + c[ia4] + c[ia1] * c[ia3]);
    c[vcu] = select(p[VCU] > zero, p[VCU], T(1e9));
    c[vcl] = select(zero < p[VCL] * p[VCL], p[VCL], T(-1e9));
  }
  /// Evaluates the filter; each denominator may be of order 2, 1 or 0.
  template <class T>
  static T filter(const T* c, const T* x, const T& u, T* dx) {
    if (!any_positive(c[ia1] + c[ia2] + c[ia3] + c[ia4])) {
      dx[y] = dx[ydot] = dx[w] = dx[wdot] = T(0.0);
      return u;
    }
    const T zero(0.0);
    const auto second = c[ia2] > zero, first = c[ia1] > zero;
    const T derivative1 = (u - x[y]) * c[ia1];
    const T out = select(second, x[y], select(first, x[y], u));
    const T out_d = select(second, x[ydot], derivative1);
    const T out_dd = (u - x[y] - c[a1] * x[ydot]) * c[ia2];
    dx[y] = out_d;
    dx[ydot] = out_dd;
    const auto second2 = c[ia4] > zero, first2 = c[ia3] > zero;
    const T derivative2 = (out - x[w]) * c[ia3];
    const T in_w = select(second2, x[w], select(first2, x[w], out));
    const T in_d = select(second2, x[wdot], select(first2, derivative2, out_d));
    const T acceleration = (out - x[w] - c[a3] * x[wdot]) * c[ia4];
    const T in_dd = select(second2, acceleration, select(first2, (out_d - derivative2) * c[ia3], out_dd));
    dx[w] = select(second2, x[wdot], derivative2);
    dx[wdot] = acceleration;
    return in_w + c[a5] * in_d + c[a6] * in_dd;
  }
  template <class T>
  static T input(const T* c, const T* x, const Signals<T>& s) {
    T u = c[w1] * s.speed + c[w3] * s.P + c[w4] * (s.Tm - s.P) + c[w5] * s.V;
    if (any_positive(c[w2])) u = u + bus_frequency(s.Vr, s.Vi, s.V * s.V, x[xr], x[xi], c[per_lead]);
    if (any_positive(c[w6])) u = u + c[w6] * c[iTf] * (s.V - x[xr]);
    return u;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T zero(0.0);
    dx[xr] = dx[xi] = zero;
    if (any_positive(c[w2] + c[w6])) {
      dx[xr] = (c[w2] * s.Vr + c[w6] * s.V - x[xr]) * c[iTf];
      dx[xi] = (c[w2] * s.Vi - x[xi]) * c[iTf];
    }
    const T filtered = filter(c, x, input(c, x, s), dx);
    const T a = lead_lag(c[t1], c[it2], x[lead1], filtered, dx[lead1]);
    const T b = lead_lag(c[t3], c[it4], x[lead2], a, dx[lead2]);
    dx[washed] = (b - x[washed]) * c[it6];
    const T out = select(c[it6] > zero, c[wash] * (b - x[washed]), c[gain] * b);
    const T limited = clamp(out, c[low], c[high]);
    s.Vs = select(s.Vc > c[vcu], zero, select(s.Vc < c[vcl], zero, limited));
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    x[xr] = c[w2] * s.Vr + c[w6] * s.V;  // zero, with zero derivative, if unused
    x[xi] = c[w2] * s.Vi;
    x[y] = x[w] = x[lead1] = x[lead2] = x[washed] = input(c, x, s);
    x[ydot] = x[wdot] = T(0.0);
    T dx[9];
    evaluate(c, x, s, dx);
    return {};
  }
};

}  // namespace swingbank::sim::effects::stabiliser_ieeest
