#pragma once
// STAB2A: power-sensitive stabiliser of ASEA.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::stabiliser_stab2a {

struct Model {
  static constexpr std::string_view name = "STAB2A", title = "power-sensitive stabiliser (ASEA)",
                                    source = "PSS/E STAB2A; OpenIPSL, STAB2A", dyr_name = "STAB2A";
  static constexpr Slot slot = Slot::stabiliser;
  static constexpr std::string_view description = R"(
  P --> -[ K2 s T2/(1 + s T2) ]^3 --> [ K3/(1 + s T3) + K4 ] --> [ K5/(1 + s T5) ]^2 --> [-HLIM, HLIM] --> Vs
  P: electrical power on the machine's base
)";
  enum P { K2, T2, K3, T3, K4, K5, T5, HLIM };
  static constexpr Source defaults_from = literature::own(
      "washouts of 4 s and a lag that integrates above 0.1 Hz; no published sample was found");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"K2", "K2", "pu", 1.0, 0.0, 100.0, kNoNullValue, "gain of each washout"},
      {"T2", "T2", "s", 4.0, 0.01, 100.0, kNoNullValue, "time constant of each washout"},
      {"K3", "K3", "pu", 0.7, 0.0, 100.0, 0.0, "gain of the lagged path"},
      {"T3", "T3", "s", 2.0, 0.01, 100.0, kNoNullValue, "time constant of the lagged path (0: none)"},
      {"K4", "K4", "pu", 0.1, -100.0, 100.0, 0.0, "gain of the direct path"},
      {"K5", "K5", "pu", 1.0, 0.0, 100.0, 0.0, "gain of each output lag"},
      {"T5", "T5", "s", 0.01, 0.0, 10.0, kNoNullValue, "time constant of each output lag (0: none)"},
      upper_limit({"HLIM", "HLIM", "pu", 0.05, 0.0, 10.0, kNoNullValue, "limit of Vs on either side"})};
  static constexpr int dyr_columns[] = {K2, T2, K3, T3, K4, K5, T5, HLIM};
  enum C { k2, iT2, k3, iT3, k4, k5, iT5, limit, coefficients };
  enum X { wash1, wash2, wash3, slow, out1, out2 };
  static constexpr State states[] = {{"wash1", "pu", "state of the first washout", 1.0, -1, -1, {iT2}},
                                     {"wash2", "pu", "state of the second washout", 1.0, -1, -1, {iT2}},
                                     {"wash3", "pu", "state of the third washout", 1.0, -1, -1, {iT2}},
                                     {"slow", "pu", "state of the lagged path", 1.0, -1, -1, {iT3}},
                                     {"out1", "pu", "first output lag", 1.0, -1, -1, {iT5}},
                                     {"out2", "pu", "second output lag", 1.0, -1, -1, {iT5}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_time(T2, p[K2] != 0 && p[K5] != 0, "K2 = 0 or K5 = 0");
    values.require_times({T3, T5});
    values.refuse_negative({HLIM}, "the limits cross");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[k2] = p[K2];
    c[iT2] = inverse(p[T2]);
    c[k3] = p[K3];
    c[iT3] = inverse(p[T3]);
    c[k4] = p[K4];
    c[k5] = p[K5];
    c[iT5] = inverse(p[T5]);
    c[limit] = p[HLIM];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    T u = T(0.0) - s.P;
    for (int i = wash1; i <= wash3; ++i) u = c[k2] * washout(c[iT2], x[i], u, dx[i]);
    u = c[k4] * u + lag(c[iT3], x[slow], c[k3] * u, dx[slow]);
    for (int i = out1; i <= out2; ++i) u = lag(c[iT5], x[i], c[k5] * u, dx[i]);
    s.Vs = clamp(u, T(0.0) - c[limit], c[limit]);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    for (int i = wash2; i <= out2; ++i) x[i] = T(0.0);
    x[wash1] = T(0.0) - s.P;
    T dx[std::size(states)];
    evaluate(c, x, s, dx);
    return {};
  }
};

}  // namespace swingbank::sim::effects::stabiliser_stab2a
