#pragma once
// PSS2B: dual-input power system stabiliser.
#include <fmt/format.h>

#include <tuple>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::stabiliser_pss2b {

struct Model {
  static constexpr std::string_view name = "PSS2B",
                                    title = "dual-input power system stabiliser, type PSS2B of 2005",
                                    source = "IEEE Std 421.5-2005, 8.2, type PSS2B; PSS/E PSS2B",
                                    dyr_name = "PSS2B";
  static constexpr Slot slot = Slot::stabiliser;
  static constexpr std::string_view description = R"(
  u1 -> [VS1MIN, VS1MAX] -> s Tw1/(1 + s Tw1) -> s Tw2/(1 + s Tw2) -> 1/(1 + s T6) -> y1
  u2 -> [VS2MIN, VS2MAX] -> s Tw3/(1 + s Tw3) -> s Tw4/(1 + s Tw4) -> KS2/(1 + s T7) -> y2
  y1 + KS3 y2 -> [ (1 + s T8)/(1 + s T9)^M ]^N -> r
  r - y2 -> KS1 -> (1 + s T1)/(1 + s T2) -> (1 + s T3)/(1 + s T4) -> (1 + s T10)/(1 + s T11)
         -> [VSTMIN, VSTMAX] -> Vs
  u1 (IC1), u2 (IC2): speed deviation (1), electrical power on the machine's base (3), accelerating power
     Pm - P (4), voltage (5).
  Bypassed: washout 2 with Tw2 = 0, washout 4 with Tw4 = 0, lags with T6, T7 = 0, lead-lags with T2, T4,
     T11 = 0, the ramp-tracking filter with M = 0 or N = 0. KS1 = 0 disables all, KS2 = 0 the second
     input. Tw1, Tw3 and T9 may be 0 if their part is disabled or bypassed.
)";
  enum P {
    IC1,
    REM1,
    IC2,
    REM2,
    M,
    N,
    TW1,
    TW2,
    T6,
    TW3,
    TW4,
    T7,
    KS2,
    KS3,
    T8,
    T9,
    KS1,
    T1,
    T2,
    T3,
    T4,
    T10,
    T11,
    VS1MAX,
    VS1MIN,
    VS2MAX,
    VS2MIN,
    VSTMAX,
    VSTMIN,
    parameter_count
  };
  static constexpr Source kRange = literature::sienna("PSS2B");
  static constexpr Source defaults_from = literature::cim("PssIEEE2B");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"IC1", "IC1", "code", 1.0, 1.0, 6.0, kNoNullValue,
       "first input: 1 speed, 3 electrical, 4 accelerating power, 5 voltage", kAsEffect, kRange},
      {"REMBUS1", "REMBUS1", "code", 0.0, 0.0, 999997.0, kNoNullValue,
       "remote bus of the first input (0: the machine's own)", literature::own("the machine's own bus"),
       shared::kBusNumber},
      {"IC2", "IC2", "code", 3.0, 1.0, 6.0, kNoNullValue, "second input, as the first", kAsEffect, kRange},
      {"REMBUS2", "REMBUS2", "code", 0.0, 0.0, 999997.0, kNoNullValue,
       "remote bus of the second input (0: the machine's own)", literature::own("the machine's own bus"),
       shared::kBusNumber},
      {"M", "M", "code", 5.0, 0.0, 8.0, kNoNullValue, "ramp-tracking filter: lags per stage", kAsEffect,
       kRange},
      {"N", "N", "code", 1.0, 0.0, 8.0, kNoNullValue, "ramp-tracking filter: stages, M N <= 8", kAsEffect,
       kRange},
      {"Tw1", "Tw1", "s", 2.0, 0.01, 100.0, kNoNullValue, "first washout of the first input"},
      {"Tw2", "Tw2", "s", 2.0, 0.0, 100.0, kNoNullValue, "second washout of the first input (0: bypass)"},
      {"T6", "T6", "s", 0.02, 0.0, 10.0, kNoNullValue, "lag of the first input (0: bypass)",
       literature::own("one cycle of 50 Hz; CIM has no default")},
      {"Tw3", "Tw3", "s", 2.0, 0.01, 100.0, kNoNullValue, "first washout of the second input"},
      {"Tw4", "Tw4", "s", 0.0, 0.0, 100.0, kNoNullValue, "second washout of the second input (0: bypass)"},
      {"T7", "T7", "s", 2.0, 0.0, 100.0, kNoNullValue, "lag of the second input (0: bypass)"},
      {"KS2", "KS2", "pu", 0.2, -10.0, 10.0, kNoNullValue, "gain of the second input, about T7/(2 H)"},
      {"KS3", "KS3", "pu", 1.0, -10.0, 10.0, kNoNullValue,
       "gain of the second input into the ramp-tracking filter"},
      {"T8", "T8", "s", 0.5, 0.0, 10.0, kNoNullValue, "ramp-tracking filter's lead, about M T9",
       literature::derived("M T9, so that a ramp passes; CIM has 0.2")},
      {"T9", "T9", "s", 0.1, 0.005, 10.0, kNoNullValue, "ramp-tracking filter's lag"},
      {"KS1", "KS1", "pu", 10.0, -1000.0, 1000.0, 0.0, "gain", literature::own("CIM has 12")},
      {"T1", "T1", "s", 0.25, 0.0, 20.0, kNoNullValue, "first lead", literature::own("CIM has 0.12")},
      {"T2", "T2", "s", 0.03, 0.0, 20.0, kNoNullValue, "first lag (0: bypass)",
       literature::own("CIM has 0.02")},
      {"T3", "T3", "s", 0.15, 0.0, 20.0, kNoNullValue, "second lead", literature::own("CIM has 0.3")},
      {"T4", "T4", "s", 0.03, 0.0, 20.0, kNoNullValue, "second lag (0: bypass)",
       literature::own("CIM has 0.02")},
      {"T10", "T10", "s", 0.02, 0.0, 20.0, kNoNullValue, "third lead",
       literature::own("not zero, so that the lead-lag acts; CIM has no default")},
      {"T11", "T11", "s", 0.03, 0.0, 20.0, kNoNullValue, "third lag (0: bypass)",
       literature::own("not zero, so that the lead-lag acts; CIM has no default")},
      upper_limit(
          {"VS1MAX", "VS1MAX", "pu", 2.0, 0.0, 100.0, kNoNullValue, "upper limit of the first input"}),
      lower_limit(
          {"VS1MIN", "VS1MIN", "pu", -2.0, -100.0, 0.0, kNoNullValue, "lower limit of the first input"}),
      upper_limit(
          {"VS2MAX", "VS2MAX", "pu", 2.0, 0.0, 100.0, kNoNullValue, "upper limit of the second input"}),
      lower_limit(
          {"VS2MIN", "VS2MIN", "pu", -2.0, -100.0, 0.0, kNoNullValue, "lower limit of the second input"}),
      upper_limit({"VSTMAX", "VSTMAX", "pu", 0.1, 0.0, 10.0, kNoNullValue, "upper limit of Vs"}),
      lower_limit({"VSTMIN", "VSTMIN", "pu", -0.1, -10.0, 0.0, kNoNullValue, "lower limit of Vs"})};
  static constexpr auto dyr_columns = shared::columns_to<VSTMIN>();
  static constexpr int kRampLags = 8;  ///< maximum number of first-order lags of the ramp-tracking filter
  enum C {
    a1,  // weights of speed, P, Tm - P, V in the first input
    a2 = a1 + 4,
    iTw1 = a2 + 4,
    iTw2,
    iT6,
    iTw3,
    iTw4,
    iT7,
    ks2,
    ks3,
    ks1,
    t1,
    it2,
    t3,
    it4,
    t10,
    it11,
    low1,
    high1,
    low2,
    high2,
    low,
    high,
    lead,
    slow = lead + kRampLags,
    coefficients = slow + kRampLags
  };
  enum X { w1, w2, y1, w3, w4, y2, ramp, lead1 = ramp + kRampLags, lead2, lead3 };
  /// Weight in step size control: KS1 and the leads amplify every state by some tens, and the exciter's gain
  /// multiplies the result.
  static constexpr double kGainWeight = 10.0;
  static constexpr State states[] = {
      {"w1", "pu", "first washout of the first input", kGainWeight, -1, -1, {iTw1}},
      {"w2", "pu", "second washout of the first input", kGainWeight, -1, -1, {iTw2}},
      {"y1", "pu", "first input, filtered", kGainWeight, -1, -1, {iT6}},
      {"w3", "pu", "first washout of the second input", kGainWeight, -1, -1, {iTw3}},
      {"w4", "pu", "second washout of the second input", kGainWeight, -1, -1, {iTw4}},
      {"y2", "pu", "second input, filtered", kGainWeight, -1, -1, {iT7}},
      {"ramp1", "pu", "ramp-tracking filter, first lag", kGainWeight, -1, -1, {slow}},
      {"ramp2", "pu", "ramp-tracking filter, second lag", kGainWeight, -1, -1, {slow + 1}},
      {"ramp3", "pu", "ramp-tracking filter, third lag", kGainWeight, -1, -1, {slow + 2}},
      {"ramp4", "pu", "ramp-tracking filter, fourth lag", kGainWeight, -1, -1, {slow + 3}},
      {"ramp5", "pu", "ramp-tracking filter, fifth lag", kGainWeight, -1, -1, {slow + 4}},
      {"ramp6", "pu", "ramp-tracking filter, sixth lag", kGainWeight, -1, -1, {slow + 5}},
      {"ramp7", "pu", "ramp-tracking filter, seventh lag", kGainWeight, -1, -1, {slow + 6}},
      {"ramp8", "pu", "ramp-tracking filter, eighth lag", kGainWeight, -1, -1, {slow + 7}},
      {"lead1", "pu", "state of the first lead-lag", kGainWeight, -1, -1, {it2}},
      {"lead2", "pu", "state of the second lead-lag", kGainWeight, -1, -1, {it4}},
      {"lead3", "pu", "state of the third lead-lag", kGainWeight, -1, -1, {it11}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    check_as(name, p, where, problems);
  }
  /// Checks the parameters, also for PSS2A; `who`: model name for messages.
  static void check_as(std::string_view who, const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(who, parameters, p, where, problems);
    for (int i : {IC1, IC2})
      values.refuse(
          p[i] != 1.0 && p[i] != 3.0 && p[i] != 4.0 && p[i] != 5.0, i,
          fmt::format("{} reads speed (1), electrical power (3), accelerating power (4) or voltage (5); bus "
                      "frequency (2) and voltage derivative (6) are not modelled",
                      who),
          fmt::format("give {} = 1, 3, 4 or 5", parameters[i].symbol));
    for (int i : {REM1, REM2})  // p[i - 1]: input code; the bus concerns the voltage only
      values.refuse(p[i] != 0.0 && p[i - 1] == 5.0, i,
                    fmt::format("{} measures the voltage of its own machine only", who),
                    fmt::format("give {} = 0", parameters[i].symbol));
    for (int i : {M, N})
      values.refuse(!(p[i] >= 0.0) || p[i] != static_cast<int>(p[i]), i,
                    i == M ? "it is the number of lags of a stage" : "it is the number of stages",
                    "give a whole number >= 0");
    values.refuse(p[M] * p[N] > kRampLags, values.text(M, N), "the ramp-tracking filter has at most 8 lags",
                  "give M N <= 8");
    const bool on = p[KS1] != 0, second = on && p[KS2] != 0, ramp = on && p[M] * p[N] != 0;
    for (const auto& [time, acts, off] :
         {std::tuple{TW1, on, "KS1 = 0"}, {TW3, second, "KS2 = 0"}, {T9, ramp, "M = 0 or N = 0"}})
      values.require_time(time, acts, off);
    values.require_times({TW2, T6, TW4, T7, T2, T4, T11});
    values.require_above(VS1MAX, VS1MIN, "the range of the input must not be empty");
    values.require_above(VS2MAX, VS2MIN, "the range of the input must not be empty");
    values.require_ranges({{VSTMAX, VSTMIN}});
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    weights(p[IC1], c + a1);
    weights(p[IC2], c + a2);
    for (const auto& [to, from] : {std::pair<int, int>{iTw1, TW1},
                                   {iTw2, TW2},
                                   {iT6, T6},
                                   {iTw3, TW3},
                                   {iTw4, TW4},
                                   {iT7, T7},
                                   {it2, T2},
                                   {it4, T4},
                                   {it11, T11}})
      c[to] = inverse(p[from]);
    for (const auto& [to, from] : {std::pair<int, int>{ks1, KS1},
                                   {ks2, KS2},
                                   {ks3, KS3},
                                   {t1, T1},
                                   {t3, T3},
                                   {t10, T10},
                                   {low1, VS1MIN},
                                   {high1, VS1MAX},
                                   {low2, VS2MIN},
                                   {high2, VS2MAX},
                                   {low, VSTMIN},
                                   {high, VSTMAX}})
      c[to] = p[from];
    ramp_tracking(p, c);
  }
  /// Sets the weights of speed, electrical power, accelerating power and voltage for an input code.
  template <class T>
  static void weights(const T& code, T* w) {
    const double codes[] = {1.0, 3.0, 4.0, 5.0};
    for (int i = 0; i < 4; ++i) w[i] = select(square(code - T(codes[i])) < T(0.25), T(1.0), T(0.0));
  }
  /// Distributes N stages of M lags to kRampLags lags in series. The first lag of each stage also has the
  /// lead; unused lags pass their input.
  template <class T>
  static void ramp_tracking(const T* p, T* c) {
    const T zero(0.0);
    for (int k = 0; k < kRampLags; ++k) {
      c[slow + k] = select(T(k + 0.5) < p[M] * p[N], inverse(p[T9]), zero);
      c[lead + k] = zero;
      for (int stage = 0; stage < kRampLags; ++stage)
        c[lead + k] = select(square(p[M] * T(stage) - T(k)) < T(0.25), p[T8], c[lead + k]);
    }
  }
  /// Washout sT/(1 + sT); T = 0 passes the input.
  template <class T>
  static T washout_or_pass(const T& inverse_T, const T& x, const T& u, T& dx) {
    dx = (u - x) * inverse_T;
    return select(inverse_T > T(0.0), u - x, u);
  }
  template <class T>
  static T input(const T* w, const Signals<T>& s) {
    return w[0] * s.speed + w[1] * s.P + w[2] * (s.Tm - s.P) + w[3] * s.V;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T u1 = clamp(input(c + a1, s), c[low1], c[high1]);
    const T u2 = clamp(input(c + a2, s), c[low2], c[high2]);
    const T washed1 = washout_or_pass(c[iTw2], x[w2], washout(c[iTw1], x[w1], u1, dx[w1]), dx[w2]);
    const T washed2 = washout_or_pass(c[iTw4], x[w4], washout(c[iTw3], x[w3], u2, dx[w3]), dx[w4]);
    const T first = lag(c[iT6], x[y1], washed1, dx[y1]);
    const T second = lag(c[iT7], x[y2], c[ks2] * washed2, dx[y2]);
    T r = first + c[ks3] * second;
    for (int k = 0; k < kRampLags; ++k) r = lead_lag(c[lead + k], c[slow + k], x[ramp + k], r, dx[ramp + k]);
    const T a = lead_lag(c[t1], c[it2], x[lead1], c[ks1] * (r - second), dx[lead1]);
    const T b = lead_lag(c[t3], c[it4], x[lead2], a, dx[lead2]);
    s.Vs = clamp(lead_lag(c[t10], c[it11], x[lead3], b, dx[lead3]), c[low], c[high]);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    for (int i = 0; i < static_cast<int>(std::size(states)); ++i) x[i] = T(0.0);
    x[w1] = input(c + a1, s);
    x[w3] = input(c + a2, s);
    for (const auto& [state, most, least] : {std::tuple{w1, VS1MAX, VS1MIN}, {w3, VS2MAX, VS2MIN}}) {
      const double now = value_of(x[state]);
      if (now > value_of(p[most]) || now < value_of(p[least]))
        return fmt::format("an input of {:.4f} pu is outside the range from {} = {:g} to {} = {:g} pu", now,
                           parameters[least].symbol, value_of(p[least]), parameters[most].symbol,
                           value_of(p[most]));
    }
    T dx[std::size(states)];
    evaluate(c, x, s, dx);
    return {};
  }
};

}  // namespace swingbank::sim::effects::stabiliser_pss2b
