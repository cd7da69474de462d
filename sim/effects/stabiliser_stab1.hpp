#pragma once
// STAB1: speed-sensitive power system stabiliser.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::stabiliser_stab1 {

struct Model {
  static constexpr std::string_view name = "STAB1", title = "speed-sensitive stabiliser",
                                    source = "PSS/E STAB1", dyr_name = "STAB1";
  static constexpr Slot slot = Slot::stabiliser;
  static constexpr std::string_view description = R"(
                    K s       1 + s T1   1 + s T2
  speed deviation --------- - -------- - -------- -> [-HLIM, HLIM] -> Vs
                    1 + s T   1 + s T3   1 + s T4
  given as K/T, T, T1/T3, T3, T2/T4, T4; T3 = 0 or T4 = 0: bypass
)";
  enum P { KT, TW, T1_T3, T3, T2_T4, T4, HLIM };
  static constexpr Source defaults_from =
      literature::own("leads of 0.25/0.05 s and 0.16/0.04 s; no published sample was found");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"KT", "K/T", "pu", 10.0, -1000.0, 1000.0, 0.0, "gain above the washout's corner"},
      {"TW", "T", "s", 5.0, 0.01, 50.0, kNoNullValue, "washout"},
      {"T1_T3", "T1/T3", "-", 5.0, 0.0, 100.0, 1.0, "ratio of the first lead to lag time constant"},
      {"T3", "T3", "s", 0.05, 0.0, 20.0, kNoNullValue, "first lag (0: bypass)"},
      {"T2_T4", "T2/T4", "-", 4.0, 0.0, 100.0, 1.0, "ratio of the second lead to lag time constant"},
      {"T4", "T4", "s", 0.04, 0.0, 20.0, kNoNullValue, "second lag (0: bypass)"},
      upper_limit({"HLIM", "HLIM", "pu", 0.1, 0.0, 10.0, kNoNullValue, "limit of |Vs|"})};
  static constexpr int dyr_columns[] = {KT, TW, T1_T3, T3, T2_T4, T4, HLIM};
  enum C { gain, iT, t1, it3, t2, it4, limit, coefficients };
  enum X { washed, lead1, lead2 };
  static constexpr State states[] = {{"washed", "pu", "state of the washout", 1.0, -1, -1, {iT}},
                                     {"lead1", "pu", "state of the first lead-lag"},
                                     {"lead2", "pu", "state of the second lead-lag"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_time(TW, p[KT] != 0, "K/T = 0");
    values.require_times({T3, T4});
    values.refuse_negative({HLIM}, "a limit of the magnitude cannot be negative");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[gain] = p[KT];
    c[iT] = inverse(p[TW]);
    c[t1] = p[T1_T3] * p[T3];
    c[it3] = inverse(p[T3]);
    c[t2] = p[T2_T4] * p[T4];
    c[it4] = inverse(p[T4]);
    c[limit] = p[HLIM];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T u = c[gain] * washout(c[iT], x[washed], s.speed, dx[washed]);
    const T a = lead_lag(c[t1], c[it3], x[lead1], u, dx[lead1]);
    const T b = lead_lag(c[t2], c[it4], x[lead2], a, dx[lead2]);
    s.Vs = clamp(b, T(0.0) - c[limit], c[limit]);
  }
  template <class T>
  static std::string steady(const T*, T*, Signals<T>& s, T* x) {
    x[washed] = s.speed;
    x[lead1] = x[lead2] = s.Vs = T(0.0);
    return {};
  }
};

}  // namespace swingbank::sim::effects::stabiliser_stab1
