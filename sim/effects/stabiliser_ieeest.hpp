#pragma once
// IEEEST: the IEEE (1981) power system stabiliser.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::stabiliser_ieeest {

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
  u: speed deviation (ICS = 1), electrical power on the machine's base (3), accelerating power Pm - P (4),
     voltage (5).
  Vs = 0 while Vc > VCU or Vc < VCL (a zero switches that side off). T2, T4 = 0: bypass; T6 = 0: KS alone.
)";
  enum P { ICS, IB, A1, A2, A3, A4, A5, A6, T1, T2, T3, T4, T5, T6, KS, LSMAX, LSMIN, VCU, VCL };
  static constexpr Parameter parameters[] = {
      {"ICS", "ICS", "code", 1.0, 1.0, 6.0, kNoNeutral,
       "input: 1 speed, 3 electrical, 4 accelerating power, 5 voltage"},
      {"IB", "IB", "code", 0.0, 0.0, 999997.0, kNoNeutral, "remote bus (0: the machine's own)"},
      {"A1", "A1", "s", 0.06, 0.0, 10.0, 0.0, "filter denominator 1, first order"},
      {"A2", "A2", "s^2", 0.0016, 0.0, 10.0, 0.0, "filter denominator 1, second order"},
      {"A3", "A3", "s", 0.03, 0.0, 10.0, 0.0, "filter denominator 2, first order"},
      {"A4", "A4", "s^2", 0.0004, 0.0, 10.0, 0.0, "filter denominator 2, second order"},
      {"A5", "A5", "s", 0.0, -10.0, 10.0, 0.0, "filter numerator, first order"},
      {"A6", "A6", "s^2", 0.0, -10.0, 10.0, 0.0, "filter numerator, second order"},
      {"T1", "T1", "s", 0.1, 0.0, 20.0, kNoNeutral, "first lead"},
      {"T2", "T2", "s", 0.02, 0.0, 20.0, kNoNeutral, "first lag (0: bypass)"},
      {"T3", "T3", "s", 0.1, 0.0, 20.0, kNoNeutral, "second lead"},
      {"T4", "T4", "s", 0.02, 0.0, 20.0, kNoNeutral, "second lag (0: bypass)"},
      {"T5", "T5", "s", 5.0, 0.0, 50.0, kNoNeutral, "washout numerator"},
      {"T6", "T6", "s", 5.0, 0.0, 50.0, kNoNeutral, "washout denominator (0: bypass)"},
      {"KS", "KS", "pu", 10.0, -1000.0, 1000.0, 0.0, "gain"},
      {"LSMAX", "LSMAX", "pu", 0.1, 0.0, 10.0, kNoNeutral, "upper limit of Vs"},
      {"LSMIN", "LSMIN", "pu", -0.1, -10.0, 0.0, kNoNeutral, "lower limit of Vs"},
      {"VCU", "VCU", "pu", 1.25, 0.0, 10.0, 0.0, "no output above this voltage (0: off)"},
      {"VCL", "VCL", "pu", 0.7, -10.0, 1.0, 0.0, "no output below this voltage (0: off)"}};
  static constexpr int dyr_columns[] = {ICS, IB, A1, A2, A3, A4,    A5,    A6,  T1, T2,
                                        T3,  T4, T5, T6, KS, LSMAX, LSMIN, VCU, VCL};
  enum C {
    w1,
    w3,
    w4,
    w5,
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
    coefficients
  };
  enum X { y, ydot, w, wdot, lead1, lead2, washed };
  static constexpr State states[] = {
      {"y", "pu", "first filter's output"},           {"ydot", "pu/s", "its slope"},
      {"w", "pu", "second filter's state"},           {"wdot", "pu/s", "its slope"},
      {"lead1", "pu", "state of the first lead-lag"}, {"lead2", "pu", "state of the second lead-lag"},
      {"washed", "pu", "state of the washout"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const auto bad = [&](bool wrong, std::string what, std::string why, std::string remedy) {
      if (wrong) problems.add(std::move(what), where, std::move(why), std::move(remedy));
    };
    bad(p[ICS] != 1.0 && p[ICS] != 3.0 && p[ICS] != 4.0 && p[ICS] != 5.0, fmt::format("ICS = {:g}", p[ICS]),
        "IEEEST reads speed (1), electrical power (3), accelerating power (4) or voltage (5); bus frequency "
        "(2) and voltage slope (6) are not modelled",
        "give ICS = 1, 3, 4 or 5");
    bad(p[IB] != 0.0, fmt::format("IB = {:g}", p[IB]), "IEEEST reads its own machine only", "give IB = 0");
    for (int i : {A1, A2, A3, A4})
      bad(!(p[i] >= 0), fmt::format("{} = {:g}", parameters[i].symbol, p[i]), "the filter would be unstable",
          "give a coefficient >= 0");
    for (int i : {T2, T4, T6})
      bad(!(p[i] >= 0), fmt::format("{} = {:g} s", parameters[i].symbol, p[i]), "a time constant",
          "give a value >= 0");
    const auto order = [](double first, double second) { return second != 0.0 ? 2 : first != 0.0 ? 1 : 0; };
    bad(order(p[A5], p[A6]) > order(p[A1], p[A2]) + order(p[A3], p[A4]),
        fmt::format("A5 = {:g} s, A6 = {:g} s^2", p[A5], p[A6]),
        "the filter would differentiate: its numerator is of higher order than its denominator",
        "give A1 to A4 to match");
    bad(!(p[LSMAX] >= p[LSMIN]), fmt::format("LSMAX = {:g} pu with LSMIN = {:g} pu", p[LSMAX], p[LSMIN]),
        "the limits cross", "give LSMAX >= LSMIN");
  }
  static std::string_view unphysical(const double*) { return ""; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    const T zero(0.0), one(1.0);
    c[w1] = select(p[ICS] < T(2.0), one, zero);
    c[w5] = select(p[ICS] > T(4.5), one, zero);
    c[w4] = select(p[ICS] > T(3.5), one - c[w5], zero);
    c[w3] = one - c[w1] - c[w4] - c[w5];
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
    c[vcu] = select(p[VCU] > zero, p[VCU], T(1e9));
    c[vcl] = select(zero < p[VCL] * p[VCL], p[VCL], T(-1e9));
  }
  /// The second-order filter: either denominator may be of order 2, 1 or 0.
  template <class T>
  static T filter(const T* c, const T* x, const T& u, T* dx) {
    const T zero(0.0);
    const auto second = c[ia2] > zero, first = c[ia1] > zero;
    const T slope1 = (u - x[y]) * c[ia1];
    const T out = select(second, x[y], select(first, x[y], u));
    const T out_d = select(second, x[ydot], slope1);
    const T out_dd = (u - x[y] - c[a1] * x[ydot]) * c[ia2];
    dx[y] = out_d;
    dx[ydot] = out_dd;
    const auto second2 = c[ia4] > zero, first2 = c[ia3] > zero;
    const T slope2 = (out - x[w]) * c[ia3];
    const T in_w = select(second2, x[w], select(first2, x[w], out));
    const T in_d = select(second2, x[wdot], select(first2, slope2, out_d));
    const T acceleration = (out - x[w] - c[a3] * x[wdot]) * c[ia4];
    const T in_dd = select(second2, acceleration, select(first2, (out_d - slope2) * c[ia3], out_dd));
    dx[w] = select(second2, x[wdot], slope2);
    dx[wdot] = acceleration;
    return in_w + c[a5] * in_d + c[a6] * in_dd;
  }
  template <class T>
  static T input(const T* c, const Signals<T>& s) {
    return c[w1] * s.speed + c[w3] * s.P + c[w4] * (s.Tm - s.P) + c[w5] * s.V;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T zero(0.0);
    const T filtered = filter(c, x, input(c, s), dx);
    const T a = lead_lag(c[t1], c[it2], x[lead1], filtered, dx[lead1]);
    const T b = lead_lag(c[t3], c[it4], x[lead2], a, dx[lead2]);
    dx[washed] = (b - x[washed]) * c[it6];
    const T out = select(c[it6] > zero, c[wash] * (b - x[washed]), c[gain] * b);
    const T limited = clamp(out, c[low], c[high]);
    s.Vs = select(s.Vc > c[vcu], zero, select(s.Vc < c[vcl], zero, limited));
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    x[y] = x[w] = x[lead1] = x[lead2] = x[washed] = input(c, s);
    x[ydot] = x[wdot] = T(0.0);
    T dx[7];
    evaluate(c, x, s, dx);
    return {};
  }
};

}  // namespace swingbank::sim::stabiliser_ieeest
