#pragma once
// QUANTISE: quantisation by an instrument or its protocol.
#include <fmt/format.h>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::measurement_quantise {

struct Model {
  static constexpr std::string_view name = "QUANTISE", title = "quantisation of magnitudes and angles",
                                    source =
                                        "rounding by definition; IEEE Std C37.118.2, 6.3 (16-bit phasors, "
                                        "frequency in mHz)";
  static constexpr Slot slot = Slot::measurement;
  static constexpr std::string_view description = R"(
  |V|, |I|, angles of V and I, df --[ nearest multiple of the step ]-- each sample independently

  A step of 0 leaves the quantity unchanged. Usual steps: full scale / 32768 for a 16-bit magnitude,
  1e-4 rad for an angle, 0.001 Hz for a frequency.
)";
  enum P { V, I, angle, frequency };
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from = shared::kNoMeasurement;
  static constexpr Parameter parameters[] = {
      {"V", "qV", "pu", 0.0, 0.0, 0.1, 0.0, "step of the voltage's magnitude"},
      {"I", "qI", "pu", 0.0, 0.0, 0.1, 0.0, "step of the current's magnitude"},
      {"angle", "qa", "rad", 0.0, 0.0, 0.1, 0.0, "step of both angles"},
      {"frequency", "qf", "Hz", 0.0, 0.0, 1.0, 0.0, "step of the frequency"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    for (const P i : {V, I, angle, frequency})
      if (!(p[i] >= 0))
        problems.add(fmt::format("{} = {:g} {}", parameters[i].name, p[i], parameters[i].unit), where,
                     "a step cannot be negative", "give 0 or more");
  }

  static double nearest(double value, double step) {
    return step > 0.0 ? step * std::nearbyint(value / step) : value;
  }
  static void measure(const double* p, std::uint64_t, Phasors& phasors) {
    const auto count = [&](std::vector<std::complex<double>>& list, double step) {
      if (step == 0.0 && p[angle] == 0.0) return;
      for (auto& one : list)
        one = std::polar(1.0, nearest(std::arg(one), p[angle])) * nearest(std::abs(one), step);
    };
    count(phasors.V, p[V]);
    count(phasors.I, p[I]);
    for (double& df : phasors.df) df = nearest(df, p[frequency] / phasors.frequency);
  }
};

}  // namespace swingbank::sim::effects::measurement_quantise
