#pragma once
// IEEEG1: steam turbine with up to four stages and a speed-limited valve.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::governor_ieeeg1 {

struct Model {
  static constexpr std::string_view name = "IEEEG1", title = "steam turbine with reheat stages and governor",
                                    source =
                                        "IEEE Trans. PAS-92 (1973) 1904; IEEE PES-TR1 (2013), 2.3; "
                                        "PSS/E IEEEG1",
                                    dyr_name = "IEEEG1";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view description = R"(
                                                           UO       PMAX
  b(w) --> [ K (1 + s T2)/(1 + s T1) ] --(-)--> (+) --> [ 1/T3 ]--> [ 1/s ] --valve--> [ 1/(1 + s T4) ] --x4-->
                            Pref + dPref --(+)   -valve    UC       PMIN
  x4 --> [ 1/(1 + s T5) ] --x5--> [ 1/(1 + s T6) ] --x6--> [ 1/(1 + s T7) ] --x7
  b(w): 0 within +-db, beyond it w minus the nearer edge (IEEEG1D; db = 0 is IEEEG1)
  dvalve/dt = (Pref + dPref - K (1 + s T2)/(1 + s T1) b(w) - valve)/T3
              UC <= dvalve/dt <= UO, PMIN <= valve <= PMAX without wind-up
  Pm = K1 x4 + K3 x5 + K5 x6 + K7 x7
  One shaft only: JBUS, M and the shares K2, K4, K6, K8 of a second generator are zero.
)";
  enum P { JBUS, M, K, T1, T2, T3, UO, UC, PMAX, PMIN, T4, K1, K2, T5, K3, K4, T6, K5, K6, T7, K7, K8, db };
  static constexpr Source kNone = literature::derived("there is no low-pressure generator");
  static constexpr Source kStageShare =
      literature::own("a fraction, up to 1.5 because the sum may differ from 1");
  static constexpr Source defaults_from = literature::cim("GovSteamIEEE1");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"JBUS", "JBUS", "code", 0.0, 0.0, 0.0, 0.0, "bus of the low-pressure generator (0: none)", kNone,
       shared::kNotModelled},
      {"M", "M", "code", 0.0, 0.0, 0.0, 0.0, "number of the low-pressure generator (0: none)", kNone,
       shared::kNotModelled},
      {"K", "K", "pu", 20.0, 1.0, 200.0, 0.0, "gain, the reciprocal of droop",
       literature::andes("IEEEG1, commit 073cb96")},
      {"T1", "T1", "s", 0.2, 0.0, 100.0, kNoNullValue, "lag of the governor (0: neither lag nor lead)",
       literature::own("a short lag")},
      {"T2", "T2", "s", 0.05, 0.0, 10.0, kNoNullValue, "lead of the governor",
       literature::own("a quarter of T1, so that the lead acts")},
      {"T3", "T3", "s", 0.2, 0.02, 10.0, kNoNullValue, "servo time constant",
       literature::openipsl("test of IEEEG1")},
      {"UO", "UO", "pu/s", 0.2, 0.01, 10.0, kNoNullValue, "largest opening speed",
       literature::own("the whole stroke in 5 s")},
      {"UC", "UC", "pu/s", -0.3, -10.0, -0.01, kNoNullValue, "largest closing speed, negative",
       literature::own("the whole stroke in 3.3 s")},
      upper_limit({"PMAX", "PMAX", "pu", 1.0, 0.1, 5.0, kNoNullValue, "upper limit of the valve"}),
      lower_limit({"PMIN", "PMIN", "pu", 0.0, -1.0, 1.0, kNoNullValue, "lower limit of the valve"}),
      {"T4", "T4", "s", 0.3, 0.0, 10.0, kNoNullValue, "steam bowl time constant (0: none)"},
      {"K1", "K1", "pu", 0.3, 0.0, 1.5, 0.0, "share of power before the first reheater",
       literature::steps("IEEE39.dyr"), kStageShare},
      {"K2", "K2", "pu", 0.0, 0.0, 0.0, 0.0, "as K1, for the low-pressure generator", kAsEffect,
       shared::kNotModelled},
      {"T5", "T5", "s", 7.0, 0.0, 60.0, kNoNullValue, "time constant of the first reheater (0: none)",
       literature::own("near the case files' 7.5 to 8.3 s")},
      {"K3", "K3", "pu", 0.4, 0.0, 1.5, 0.0, "share of power after the first reheater",
       literature::own("so that the shares sum to 1"), kStageShare},
      {"K4", "K4", "pu", 0.0, 0.0, 0.0, 0.0, "as K3, for the low-pressure generator", kAsEffect,
       shared::kNotModelled},
      {"T6", "T6", "s", 0.5, 0.0, 60.0, kNoNullValue, "time constant of the crossover (0: none)"},
      {"K5", "K5", "pu", 0.3, 0.0, 1.5, 0.0, "share of power after the crossover",
       literature::own("so that the shares sum to 1"), kStageShare},
      {"K6", "K6", "pu", 0.0, 0.0, 0.0, 0.0, "as K5, for the low-pressure generator", kAsEffect,
       shared::kNotModelled},
      {"T7", "T7", "s", 0.0, 0.0, 60.0, kNoNullValue, "time constant of the last stage (0: none)"},
      {"K7", "K7", "pu", 0.0, 0.0, 1.5, 0.0, "share of power after the last stage", kAsEffect, kStageShare},
      {"K8", "K8", "pu", 0.0, 0.0, 0.0, 0.0, "as K7, for the low-pressure generator", kAsEffect,
       shared::kNotModelled},
      {"db", "db", "pu", 0.0, 0.0, 0.02, 0.0, "half width of the intentional dead-band of the speed",
       shared::kNothing, shared::kDeadBand}};
  static constexpr int dyr_columns[] = {JBUS, M,  K,  T1, T2, T3, UO, UC, PMAX, PMIN, T4,
                                        K1,   K2, T5, K3, K4, T6, K5, K6, T7,   K7,   K8};
  enum C {
    gain,
    iT1,
    lead,
    iT3,
    opening,
    closing,
    high,
    low,
    iT4,
    iT5,
    iT6,
    iT7,
    share4,
    share5,
    share6,
    share7,
    band,
    Pref,
    coefficients
  };
  enum X { governor, valve, bowl, reheat, crossover, last };
  static constexpr State states[] = {
      {"governor", "pu", "lagged speed", 1.0, -1, -1, {iT1}},
      {"valve", "pu", "valve opening", 1.0, low, high},
      {"bowl", "pu", "flow through the steam bowl, x4", 1.0, -1, -1, {iT4}},
      {"reheat", "pu", "flow through the first reheater, x5", 1.0, -1, -1, {iT5}},
      {"crossover", "pu", "flow through the crossover, x6", 1.0, -1, -1, {iT6}},
      {"last", "pu", "flow through the last stage, x7", 1.0, -1, -1, {iT7}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    check_valve(values, p);
    check_shares(values, p[K1] + p[K3] + p[K5] + p[K7], values.text(K1, K3, K5, K7));
  }
  /// Checks all parameters but K1, K3, K5 and K7, for IEEEG1 or a model with its equations; `p`: values in
  /// the order of IEEEG1.
  static void check_valve(const shared::ValueCheck& values, const double* p);
  /// Checks the sum of the stages' shares; `text`: the shares with their values.
  static void check_shares(const shared::ValueCheck& values, double sum, const std::string& text) {
    values.refuse(!(sum > 0), text, "these fractions of the stages add up to the turbine's power",
                  "give fractions with a sum > 0");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[gain] = p[K];
    c[iT1] = inverse(p[T1]);
    c[lead] = p[T2];
    c[iT3] = T(1.0) / p[T3];
    c[opening] = p[UO];
    c[closing] = p[UC];
    c[high] = p[PMAX];
    c[low] = p[PMIN];
    c[iT4] = inverse(p[T4]);
    c[iT5] = inverse(p[T5]);
    c[iT6] = inverse(p[T6]);
    c[iT7] = inverse(p[T7]);
    c[share4] = p[K1];
    c[share5] = p[K3];
    c[share6] = p[K5];
    c[share7] = p[K7];
    c[band] = p[db];
  }
  /// Computes the valve's rate from the requested position minus `position`, which the governor feeds back
  /// [pu].
  template <class T>
  static void move_valve(const T* c, const T* x, const T& position, const Signals<T>& s, T* dx) {
    const T speed = lead_lag(c[lead], c[iT1], x[governor], dead_band(s.speed, c[band]), dx[governor]);
    const T error = c[Pref] + s.dPref + s.dGref - c[gain] * speed - position;
    dx[valve] = clamp(error * c[iT3], c[closing], c[opening]);
  }
  /// Returns the mechanical power Pm of the turbine stages after the valve [pu].
  template <class T>
  static T stages(const T* c, const T* x, const T& steam, T* dx) {
    const T x4 = lag(c[iT4], x[bowl], steam, dx[bowl]);
    const T x5 = lag(c[iT5], x[reheat], x4, dx[reheat]);
    const T x6 = lag(c[iT6], x[crossover], x5, dx[crossover]);
    const T x7 = lag(c[iT7], x[last], x6, dx[last]);
    return c[share4] * x4 + c[share5] * x5 + c[share6] * x6 + c[share7] * x7;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T steam = clamp(x[valve], c[low], c[high]);
    move_valve(c, x, steam, s, dx);
    s.Tm = stages(c, x, steam, dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    x[governor] = T(0.0);
    c[Pref] = s.Tm / (p[K1] + p[K3] + p[K5] + p[K7]);
    for (const int i : {valve, bowl, reheat, crossover, last}) x[i] = c[Pref];
    return {};
  }
};

inline void Model::check_valve(const shared::ValueCheck& values, const double* p) {
  values.require_divisors({T3});
  values.require_times({T1, T2, T4, T5, T6, T7});
  values.refuse(!(p[UO] > 0 && p[UC] < 0), values.text(UO, UC), "the valve must be able to open and to close",
                "give UO > 0 and UC < 0");
  values.require_above(PMAX, PMIN, "the range of the valve must not be empty");
  for (const int i : {JBUS, M, K2, K4, K6, K8})
    values.refuse(p[i] != 0, i, "a second, low-pressure generator is not modelled",
                  "give 0 and put its share into K1, K3, K5 or K7");
  values.refuse_negative({db}, "a width cannot be negative");
}

}  // namespace swingbank::sim::effects::governor_ieeeg1
