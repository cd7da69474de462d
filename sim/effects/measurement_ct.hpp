#pragma once
// CTERROR: ratio and phase error of the current transformers.
#include <fmt/format.h>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::measurement_ct {

struct Model {
  static constexpr std::string_view name = "CTERROR", title = "current transformer: gain and phase error",
                                    source = "IEC 61869-2 (ratio error, phase displacement); IEEE Std C57.13";
  static constexpr Slot slot = Slot::measurement;
  static constexpr std::string_view description = R"(
  I --( 1 + gain )--( e^{j phase} )-- I'

  I' = I (1 + gain) exp(j phase): constant, and therefore also visible before the event.
  Class 0.5 allows gain = 0.005 pu and phase = 0.0087 rad (30 minutes of arc) at rated current.
  In P and Q alone, gain has the effect of a wrong machine base; only phase is distinguishable.
)";
  enum P { gain, phase };
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from = shared::kBeyondClass;
  static constexpr Parameter parameters[] = {
      {"gain", "eps", "pu", 0.0, -0.5, 0.5, 0.0, "relative error of the current's magnitude"},
      {"phase", "dphi", "rad", 0.0, -0.5, 0.5, 0.0, "error of the current's angle, positive: leading"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    if (!(p[gain] > -1))
      problems.add(fmt::format("gain = {:g} pu", p[gain]), where, "the current would be zero or reversed",
                   "give gain > -1");
  }

  static void measure(const double* p, std::uint64_t, Phasors& phasors) {
    const std::complex<double> factor = std::polar(1.0 + p[gain], p[phase]);
    for (auto& current : phasors.I) current *= factor;
  }
};

}  // namespace swingbank::sim::effects::measurement_ct
