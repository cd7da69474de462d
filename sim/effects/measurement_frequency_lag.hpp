#pragma once
// FREQLAG: low-pass filter of the frequency measurement.
#include <fmt/format.h>

#include <cmath>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::measurement_frequency_lag {

struct Model {
  static constexpr std::string_view name = "FREQLAG", title = "low-pass filter of the frequency measurement",
                                    source = "first-order lag, as the frequency transducer of DER_A (Trf)";
  static constexpr Slot slot = Slot::measurement;
  static constexpr std::string_view description = R"(
  df --[ 1 / (1 + s T) ]-- df'

  T d(df')/dt = df - df'       df' = df at the first sample; df is linear between samples
  V and I are unchanged. An angle that is integrated from df' lags: its true value is
  theta + T d(theta)/dt. To first order, a delay or another filter acts like a lag with its group delay.
)";
  enum P { lag };
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from =
      literature::own("a slower measurement shows no swing; a time constant cannot be negative");
  static constexpr Parameter parameters[] = {
      {"lag", "T", "s", 0.0, 0.0, 1.0, 0.0, "time constant of the frequency's low-pass filter"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    if (!(p[lag] >= 0))
      problems.add(fmt::format("{} = {:g} s", parameters[lag].name, p[lag]), where,
                   "a time constant cannot be negative", "give 0 or more");
  }
  static double angle_lag(const double* p) { return p[lag]; }
  static double memory(const double* p) {
    constexpr double kForgotten =
        36;  // number of time constants after which only rounding remains: exp(-36) = 2e-16
    return kForgotten * p[lag];
  }

  static void measure(const double* p, std::uint64_t, Phasors& phasors) {
    if (p[lag] == 0.0 || phasors.df.empty()) return;
    const double step = 1 / (phasors.rate * p[lag]), left = std::exp(-step);
    double y = phasors.df.front(), before = y;
    for (double& df : phasors.df) {
      const double input = df;
      y = left * y + (1 - left) * before + (input - before) * (1 - (1 - left) / step);
      before = input;
      df = y;
    }
  }
};

}  // namespace swingbank::sim::effects::measurement_frequency_lag
