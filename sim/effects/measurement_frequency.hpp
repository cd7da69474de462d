#pragma once
// PMUFREQ: frequency measurement of an instrument, from the voltage angle.
#include <fmt/format.h>

#include "base/constants.hpp"
#include "sim/core/effect.hpp"
#include "sim/core/sampled.hpp"
#include "sim/core/window.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::measurement_frequency {

struct Model {
  static constexpr std::string_view name = "PMUFREQ", title = "frequency derived from the voltage's angle",
                                    source =
                                        "IEEE Std C37.118.1-2011, Annex C.4: frequency from differences of "
                                        "the angle";
  static constexpr Slot slot = Slot::measurement;
  static constexpr std::string_view description = R"(
  angle V --[ difference over `span` ]--[ average over `smoothing` ]-- df

  df(t) = (theta(t + span/2) - theta(t - span/2)) / (2 pi f0 span)      span = 0: df unchanged
  df'   = average of df over smoothing, centred                         smoothing = 0: none
  V and I are unchanged. At the record's ends the difference spans the available samples.
)";
  enum P { span, smoothing };
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from =
      literature::own("longer than any instrument's; a time cannot be negative");
  static constexpr Parameter parameters[] = {
      {"span", "Td", "s", 0.0, 0.0, 2.0, 0.0, "time over which the angle is differenced"},
      {"smoothing", "Ts", "s", 0.0, 0.0, 5.0, 0.0, "length of the subsequent average"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    for (const P i : {span, smoothing})
      if (!(p[i] >= 0))
        problems.add(fmt::format("{} = {:g} s", parameters[i].name, p[i]), where, "a time cannot be negative",
                     "give 0 or more");
  }
  static double memory(const double* p) { return 0.5 * (p[span] + p[smoothing]); }

  static void measure(const double* p, std::uint64_t, Phasors& phasors) {
    if (p[span] > 0.0) difference(p[span] * phasors.rate, phasors);
    if (p[smoothing] > 0.0)
      phasors.df = averaged(
          phasors.df, window_weights([](double) { return 1.0; }, 0.5 * p[smoothing], 1.0 / phasors.rate));
  }

  /// Computes the frequency as a difference quotient of the angle; `length`: number of samples.
  static void difference(double length, Phasors& phasors) {
    const std::vector<double> angles = continuous_angles(phasors.V);
    const SampledCurve<double> theta(angles);
    const double last = static_cast<double>(angles.size()) - 1.0;
    phasors.df.resize(angles.size());
    for (std::size_t k = 0; k < angles.size(); ++k) {
      const double at = static_cast<double>(k);
      const double a = std::max(0.0, at - 0.5 * length), b = std::min(last, at + 0.5 * length);
      if (b > a)
        phasors.df[k] =
            (theta(b) - theta(a)) * phasors.rate / ((b - a) * constants::turn * phasors.frequency);
    }
  }
};

}  // namespace swingbank::sim::effects::measurement_frequency
