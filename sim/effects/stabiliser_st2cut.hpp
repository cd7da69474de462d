#pragma once
// ST2CUT: dual-input stabiliser with a voltage cut-off.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::stabiliser_st2cut {

struct Model {
  static constexpr std::string_view name = "ST2CUT", title = "stabiliser of two inputs, cut off by voltage",
                                    source = "PSS/E ST2CUT; CIM Pss2ST; ANDES, ST2CUT", dyr_name = "ST2CUT";
  static constexpr Slot slot = Slot::stabiliser;
  static constexpr std::string_view description = R"(
  u1 --> K1/(1 + s T1) --(+)--> s T3/(1 + s T4) --> (1 + s T5)/(1 + s T6) --> (1 + s T7)/(1 + s T8)
  u2 --> K2/(1 + s T2) --(+)       --> (1 + s T9)/(1 + s T10) --> [LSMIN, LSMAX] --> Vs
  u1 (MODE), u2 (MODE2): none (0), speed deviation (1), electrical power on the machine's base (3),
     accelerating power Pm - P (4), voltage (5).
  Vs = 0 while Vc > VCU or Vc < VCL (a zero switches that side off).
  T3 = 0: 1/(1 + s T4) instead of the washout. T1, T2, T6, T8, T10 = 0, and T4 = 0 with T3 = 0: bypass.
)";
  enum P {
    MODE,
    BUSR,
    MODE2,
    BUSR2,
    K1,
    K2,
    T1,
    T2,
    T3,
    T4,
    T5,
    T6,
    T7,
    T8,
    T9,
    T10,
    LSMAX,
    LSMIN,
    VCU,
    VCL
  };
  static constexpr Source kInput = literature::own("speed alone, as IEEEST");
  static constexpr Source defaults_from =
      literature::own("speed input, two equal leads of ratio five; no published sample was found");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"MODE", "MODE", "code", 1.0, 0.0, 5.0, kNoNullValue,
       "first input: 0 none, 1 speed, 3 electrical, 4 accelerating power, 5 voltage", kInput, shared::kCode},
      {"BUSR", "BUSR", "code", 0.0, 0.0, 999997.0, kNoNullValue,
       "remote bus of the first input (0: the machine's own)", literature::own("the machine's own bus"),
       shared::kBusNumber},
      {"MODE2", "MODE2", "code", 0.0, 0.0, 5.0, kNoNullValue, "second input, as the first", kInput,
       shared::kCode},
      {"BUSR2", "BUSR2", "code", 0.0, 0.0, 999997.0, kNoNullValue,
       "remote bus of the second input (0: the machine's own)", literature::own("the machine's own bus"),
       shared::kBusNumber},
      {"K1", "K1", "pu", 10.0, -1000.0, 1000.0, 0.0, "gain of the first input"},
      {"K2", "K2", "pu", 0.0, -1000.0, 1000.0, 0.0, "gain of the second input"},
      {"T1", "T1", "s", 0.02, 0.0, 10.0, kNoNullValue, "lag of the first input (0: none)"},
      {"T2", "T2", "s", 0.02, 0.0, 10.0, kNoNullValue, "lag of the second input (0: none)"},
      {"T3", "T3", "s", 5.0, 0.0, 100.0, kNoNullValue, "washout's numerator (0: a lag instead)"},
      {"T4", "T4", "s", 5.0, 0.01, 100.0, kNoNullValue, "washout's time constant"},
      {"T5", "T5", "s", 0.1, 0.0, 20.0, kNoNullValue, "first lead"},
      {"T6", "T6", "s", 0.02, 0.0, 20.0, kNoNullValue, "first lag (0: bypass)"},
      {"T7", "T7", "s", 0.1, 0.0, 20.0, kNoNullValue, "second lead"},
      {"T8", "T8", "s", 0.02, 0.0, 20.0, kNoNullValue, "second lag (0: bypass)"},
      {"T9", "T9", "s", 0.0, 0.0, 20.0, kNoNullValue, "third lead"},
      {"T10", "T10", "s", 0.0, 0.0, 20.0, kNoNullValue, "third lag (0: bypass)"},
      upper_limit({"LSMAX", "LSMAX", "pu", 0.1, 0.0, 10.0, kNoNullValue, "upper limit of Vs"}),
      lower_limit({"LSMIN", "LSMIN", "pu", -0.1, -10.0, 0.0, kNoNullValue, "lower limit of Vs"}),
      {"VCU", "VCU", "pu", 1.25, 0.0, 10.0, 0.0, "no output above this voltage (0: off)"},
      {"VCL", "VCL", "pu", 0.7, -10.0, 1.0, 0.0, "no output below this voltage (0: off)"}};
  static constexpr int dyr_columns[] = {MODE, BUSR, MODE2, BUSR2, K1, K2,  T1,    T2,    T3,  T4,
                                        T5,   T6,   T7,    T8,    T9, T10, LSMAX, LSMIN, VCU, VCL};
  static constexpr int kInputs = 4;  ///< speed, P, Tm - P, V
  enum C {
    u1,
    u2 = u1 + kInputs,
    k1 = u2 + kInputs,
    k2,
    iT1,
    iT2,
    wash,
    iT4,
    passes,  ///< 1 if a lag replaces the washout
    t5,
    iT6,
    t7,
    iT8,
    t9,
    iT10,
    low,
    high,
    vcu,
    vcl,
    coefficients
  };
  enum X { in1, in2, washed, lead1, lead2, lead3 };
  static constexpr State states[] = {{"in1", "pu", "first input, lagged", 1.0, -1, -1, {iT1}},
                                     {"in2", "pu", "second input, lagged", 1.0, -1, -1, {iT2}},
                                     {"washed", "pu", "state of the washout", 1.0, -1, -1, {iT4}},
                                     {"lead1", "pu", "state of the first lead-lag", 1.0, -1, -1, {iT6}},
                                     {"lead2", "pu", "state of the second lead-lag", 1.0, -1, -1, {iT8}},
                                     {"lead3", "pu", "state of the third lead-lag", 1.0, -1, -1, {iT10}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    for (const int i : {MODE, MODE2})
      values.refuse(
          p[i] != 0.0 && p[i] != 1.0 && p[i] != 3.0 && p[i] != 4.0 && p[i] != 5.0, i,
          "ST2CUT reads nothing (0), speed (1), electrical (3) or accelerating power (4) or voltage "
          "(5); bus frequency (2) and voltage derivative (6) are not modelled",
          fmt::format("give {} = 0, 1, 3, 4 or 5", parameters[i].symbol));
    values.require_time(T4, p[T3] != 0 && (p[K1] != 0 || p[K2] != 0), "T3 = 0 or K1 = K2 = 0");
    values.require_times({T1, T2, T3, T6, T8, T10});
    values.require_ranges({{LSMAX, LSMIN}});
  }
  static std::string remark(const double* p) {
    const bool elsewhere = (p[BUSR] != 0.0 && p[MODE] == 5.0) || (p[BUSR2] != 0.0 && p[MODE2] == 5.0);
    return elsewhere ? "the remote bus is ignored: the stabiliser measures at its machine" : "";
  }
  /// A cut-off within the band of normal voltages would switch the stabiliser on and off continually.
  static std::string_view unphysical(const double* p) {
    if (p[VCU] > 0.0 && p[VCU] < 1.1) return "VCU >= 1.1";
    if (p[VCL] > 0.9) return "VCL <= 0.9";
    return "";
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    const T zero(0.0), one(1.0);
    for (const auto& [first, mode] : {std::pair<int, int>{u1, MODE}, {u2, MODE2}}) {
      constexpr double codes[kInputs] = {1.0, 3.0, 4.0, 5.0};
      for (int i = 0; i < kInputs; ++i)
        c[first + i] = select(square(p[mode] - T(codes[i])) < T(0.25), one, zero);
    }
    for (const auto& [to, from] :
         {std::pair<int, int>{iT1, T1}, {iT2, T2}, {iT4, T4}, {iT6, T6}, {iT8, T8}, {iT10, T10}})
      c[to] = inverse(p[from]);
    for (const auto& [to, from] :
         {std::pair<int, int>{k1, K1}, {k2, K2}, {t5, T5}, {t7, T7}, {t9, T9}, {low, LSMIN}, {high, LSMAX}})
      c[to] = p[from];
    c[wash] = p[T3] * c[iT4];
    c[passes] = select(p[T3] > zero, zero, one);
    c[vcu] = select(p[VCU] > zero, p[VCU], T(1e9));
    c[vcl] = select(zero < p[VCL] * p[VCL], p[VCL], T(-1e9));
  }
  template <class T>
  static T input(const T* w, const Signals<T>& s) {
    return w[0] * s.speed + w[1] * s.P + w[2] * (s.Tm - s.P) + w[3] * s.V;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T sum = lag(c[iT1], x[in1], c[k1] * input(c + u1, s), dx[in1]) +
                  lag(c[iT2], x[in2], c[k2] * input(c + u2, s), dx[in2]);
    const T lagged = lag(c[iT4], x[washed], sum, dx[washed]);
    const T out = c[wash] * (sum - x[washed]) + c[passes] * lagged;
    const T a = lead_lag(c[t5], c[iT6], x[lead1], out, dx[lead1]);
    const T b = lead_lag(c[t7], c[iT8], x[lead2], a, dx[lead2]);
    const T limited = clamp(lead_lag(c[t9], c[iT10], x[lead3], b, dx[lead3]), c[low], c[high]);
    s.Vs = select(s.Vc > c[vcu], T(0.0), select(s.Vc < c[vcl], T(0.0), limited));
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    x[in1] = c[k1] * input(c + u1, s);
    x[in2] = c[k2] * input(c + u2, s);
    x[washed] = x[in1] + x[in2];
    x[lead1] = x[lead2] = x[lead3] = c[passes] * x[washed];
    T dx[std::size(states)];
    evaluate(c, x, s, dx);
    return {};
  }
};

}  // namespace swingbank::sim::effects::stabiliser_st2cut
