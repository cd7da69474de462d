#pragma once
// NOISE: Gaussian noise of an instrument.
#include <fmt/format.h>

#include "sim/core/effect.hpp"
#include "sim/core/noise.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::measurement_noise {

struct Model {
  static constexpr std::string_view name = "NOISE", title = "Gaussian noise of phasors and frequency",
                                    source =
                                        "white noise by definition; Brown, Biswal, "
                                        "Brahma, Ranade, Cao, \"Characterizing and "
                                        "quantifying noise in PMU data\", IEEE PESGM 2016";
  static constexpr Slot slot = Slot::measurement;
  static constexpr std::string_view description = R"(
  V --( 1 + sr g1 )--( e^{j sa g2} )--( + sV (g3 + j g4) )-- V'       I likewise with sI and its own g
  df' = df + sf g5 / f0

  Every g is standard normal, independent between channels and samples. The same seed gives the same noise,
  whatever the record's length. It is white at the sampling rate; a subsequent filter colours it.
)";
  enum P { relative, V, I, angle, frequency };
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from = shared::kNoMeasurement;
  static constexpr Parameter parameters[] = {
      {"relative", "sr", "pu", 0.0, 0.0, 0.1, 0.0, "relative standard deviation of either magnitude"},
      {"V", "sV", "pu", 0.0, 0.0, 0.1, 0.0, "standard deviation of the voltage's real and imaginary part"},
      {"I", "sI", "pu", 0.0, 0.0, 0.1, 0.0, "standard deviation of the current's real and imaginary part"},
      {"angle", "sa", "rad", 0.0, 0.0, 0.1, 0.0, "standard deviation of either angle"},
      {"frequency", "sf", "Hz", 0.0, 0.0, 1.0, 0.0, "standard deviation of the frequency"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    for (const P i : {relative, V, I, angle, frequency})
      if (!(p[i] >= 0))
        problems.add(fmt::format("{} = {:g} {}", parameters[i].name, p[i], parameters[i].unit), where,
                     "a standard deviation cannot be negative", "give 0 or more");
  }

  /// Random-number streams, separate so that one kind of noise does not affect the others.
  enum Stream : std::uint32_t { of_V = 1, of_I, onto_V, onto_I, of_frequency };

  static void measure(const double* p, std::uint64_t seed, Phasors& phasors) {
    const auto add = [&](std::vector<std::complex<double>>& list, Stream own, Stream onto, double absolute) {
      for (std::size_t k = 0; k < list.size(); ++k) {
        if (p[relative] > 0.0 || p[angle] > 0.0) {
          const auto g = normal_pair(seed, own, k);
          list[k] *= (1.0 + p[relative] * g[0]) * std::polar(1.0, p[angle] * g[1]);
        }
        if (absolute > 0.0) {
          const auto g = normal_pair(seed, onto, k);
          list[k] += absolute * std::complex<double>(g[0], g[1]);
        }
      }
    };
    add(phasors.V, of_V, onto_V, p[V]);
    add(phasors.I, of_I, onto_I, p[I]);
    if (p[frequency] == 0.0) return;
    for (std::size_t k = 0; k < phasors.df.size(); ++k)
      phasors.df[k] += p[frequency] / phasors.frequency * normal_pair(seed, of_frequency, k)[0];
  }
};

}  // namespace swingbank::sim::effects::measurement_noise
