#pragma once
// SKEW: delay of the current channel relative to the voltage channel.
#include "sim/core/effect.hpp"
#include "sim/core/sampled.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::measurement_skew {

struct Model {
  static constexpr std::string_view name = "SKEW", title = "time skew of the current against the voltage",
                                    source =
                                        "displacement in time by definition; "
                                        "IEEE Std C37.118.1, 4.3 (time stamps)";
  static constexpr Slot slot = Slot::measurement;
  static constexpr std::string_view description = R"(
  I --[ delay of `skew` ]-- I'

  I'(t) = I(t - skew), of the phasor in the synchronous frame: the whole channel is delayed. (A late
  sampling clock also turns the phasor by 2 pi f0 skew; that is CTERROR's phase.)
  Between samples: a cubic, and a straight line across a step, so that only a sample inside the step
  has an intermediate value. Outside the record the current is constant.
)";
  enum P { skew };
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from =
      literature::own("a delay above 1 s means records of different events");
  static constexpr Parameter parameters[] = {
      {"skew", "tau", "s", 0.0, -1.0, 1.0, 0.0, "delay of the current"}};

  static void check(const double*, const std::string&, Problems&) {}
  static double memory(const double* p) { return std::abs(p[skew]); }

  static void measure(const double* p, std::uint64_t, Phasors& phasors) {
    if (p[skew] == 0.0) return;
    const std::vector<std::complex<double>> before = phasors.I;
    const SampledCurve<std::complex<double>> curve(before);
    const double shift = p[skew] * phasors.rate;
    for (std::size_t k = 0; k < before.size(); ++k) phasors.I[k] = curve(static_cast<double>(k) - shift);
  }
};

}  // namespace swingbank::sim::effects::measurement_skew
