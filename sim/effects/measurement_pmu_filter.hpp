#pragma once
// PMUFILTER: the filter of a phasor measurement unit, class P or M.
#include <fmt/format.h>

#include "base/constants.hpp"
#include "sim/core/effect.hpp"
#include "sim/core/pmu_window.hpp"
#include "sim/core/window.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::measurement_pmu_filter {

struct Model {
  static constexpr std::string_view name = "PMUFILTER", title = "filter of a phasor measurement unit",
                                    source =
                                        "IEEE Std C37.118.1-2011, Annex C (2018, Annex D): reference models "
                                        "of class P and M";
  static constexpr Slot slot = Slot::measurement;
  static constexpr std::string_view description = R"(
  V, I --[ average over the window w ]--( class P: 1 / sin )-- V', I'       df = d(angle V')/dt / (2 pi f0)

  class 0 (P): w(t) = 1 - |t| / T,  |t| < T = scale / f0              two cycles at scale = 1
               with compensation = 1, V' and I' are divided by sin(pi/2 (1 + 1.625 scale df)),
               which restores the magnitude off nominal frequency
  class 1 (M): w(t) = sin(x) / x (0.54 + 0.46 cos(pi t / L)),  |t| < L,  x = 4 pi Ffr t / scale
               Ffr and the order N from the standard's table for the reports per second, L = scale N / (32 f0)
  The same w for V and I. The window is integrated over a cubic through the samples, independent of their rate;
  outside the record the phasors are constant. A step is only as sharp as the samples resolve it.
)";
  enum P { klass, scale, reports, compensation };
  static constexpr Source defaults_from = literature::own("class P, the default");
  static constexpr Source bounds_from = shared::kCode;
  static constexpr Parameter parameters[] = {
      {"class", "class", "code", 0.0, 0.0, 1.0, kNoNullValue, "0: class P, 1: class M"},
      {"scale", "s", "-", 1.0, 0.0, 10.0, 0.0, "length of the window over that of the standard",
       literature::c37("annex C"), literature::own("0: no filter; ten times the standard")},
      {"reports", "Fs", "code", 60.0, 10.0, 120.0, kNoNullValue,
       "reports per second, which select the window of class M", literature::c37("reporting rates at 60 Hz"),
       literature::c37("reporting rates, 10 to 120")},
      {"compensation", "comp", "code", 1.0, 0.0, 1.0, kNoNullValue,
       "1: class P corrects the magnitude off nominal frequency, 0: it does not",
       literature::c37("annex C")}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const auto either = [&](P i) {
      if (p[i] != 0.0 && p[i] != 1.0)
        problems.add(fmt::format("{} = {:g}", parameters[i].name, p[i]), where, "only 0 and 1 are defined",
                     "give 0 or 1");
    };
    either(klass);
    either(compensation);
    if (!(p[scale] >= 0))
      problems.add(fmt::format("scale = {:g}", p[scale]), where, "a length cannot be negative",
                   "give scale >= 0");
    if (p[klass] == 1.0 && !pmu_window::find(50.0, p[reports]) && !pmu_window::find(60.0, p[reports]))
      problems.add(
          fmt::format("reports = {:g} per second", p[reports]), where,
          "class M has windows for 10, 25, 50, 100 at 50 Hz and 10, 12, 15, 20, 30, 60, 120 at 60 Hz",
          "give one of these");
  }
  static double half_length(const double* p, double hz) {
    if (p[klass] == 0.0) return p[scale] * pmu_window::kHalfOfP / hz;
    const pmu_window::MClass* row = pmu_window::find(hz, p[reports]);
    return row ? p[scale] * row->half(hz) : 0.0;
  }
  /// Returns the half length of the window [s], the larger of its values at 50 and 60 Hz.
  static double memory(const double* p) { return std::max(half_length(p, 50.0), half_length(p, 60.0)); }

  /// Applies the filter. Throws InputError if class M has no window for this reporting rate and system
  /// frequency.
  static void measure(const double* p, std::uint64_t, Phasors& phasors) {
    if (p[scale] == 0.0) return;
    const double f0 = phasors.frequency, half = half_length(p, f0);
    if (p[klass] == 1.0 && half == 0.0)
      throw InputError({fmt::format("class M at {:g} reports per second", p[reports]),
                        fmt::format("PMUFILTER, {:g} Hz", f0), "the standard has no such window",
                        f0 == 50.0 ? "give reports = 10, 25, 50 or 100"
                                   : "give reports = 10, 12, 15, 20, 30, 60 or 120 (in a 60 Hz system)"});
    const double Ffr = p[klass] == 1.0 ? pmu_window::find(f0, p[reports])->Ffr / p[scale] : 0.0;
    const auto window = [&](double t) {
      return p[klass] == 0.0 ? pmu_window::class_p(t, half) : pmu_window::class_m(t, half, Ffr);
    };
    const auto weights = window_weights(window, half, 1.0 / phasors.rate);
    phasors.V = averaged(phasors.V, weights);
    phasors.I = averaged(phasors.I, weights);
    phasors.df = frequency_deviation(continuous_angles(phasors.V), phasors.rate, f0);
    if (p[klass] == 1.0 || p[compensation] == 0.0) return;
    for (std::size_t k = 0; k < phasors.V.size(); ++k) {
      const double gain = std::sin(0.5 * constants::pi * (1.0 + 1.625 * p[scale] * phasors.df[k]));
      phasors.V[k] /= gain;
      phasors.I[k] /= gain;
    }
  }
};

}  // namespace swingbank::sim::effects::measurement_pmu_filter
