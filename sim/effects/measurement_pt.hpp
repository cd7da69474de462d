#pragma once
// PTERROR: ratio and phase error of the voltage transformers.
#include <fmt/format.h>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::measurement_pt {

struct Model {
  static constexpr std::string_view name = "PTERROR", title = "voltage transformer: gain and phase error",
                                    source = "IEC 61869-3, 61869-5 (ratio error, phase displacement)";
  static constexpr Slot slot = Slot::measurement;
  static constexpr std::string_view description = R"(
  V --( 1 + gain )--( e^{j phase} )-- V'

  V' = V (1 + gain) exp(j phase): constant, and therefore also visible before the event.
  Class 0.5 allows gain = 0.005 pu and phase = 0.0058 rad (20 minutes of arc) at rated voltage.
)";
  enum P { gain, phase };
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from = shared::kBeyondClass;
  static constexpr Parameter parameters[] = {
      {"gain", "eps", "pu", 0.0, -0.5, 0.5, 0.0, "relative error of the voltage's magnitude"},
      {"phase", "dphi", "rad", 0.0, -0.5, 0.5, 0.0, "error of the voltage's angle, positive: leading"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    if (!(p[gain] > -1))
      problems.add(fmt::format("gain = {:g} pu", p[gain]), where, "the voltage would be zero or reversed",
                   "give gain > -1");
  }

  static void measure(const double* p, std::uint64_t, Phasors& phasors) {
    const std::complex<double> factor = std::polar(1.0 + p[gain], p[phase]);
    for (auto& voltage : phasors.V) voltage *= factor;
  }
};

}  // namespace swingbank::sim::effects::measurement_pt
