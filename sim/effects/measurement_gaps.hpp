#pragma once
// GAPS: missing samples.
#include <fmt/format.h>

#include <limits>

#include "sim/core/effect.hpp"
#include "sim/core/noise.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::measurement_gaps {

struct Model {
  static constexpr std::string_view name = "GAPS", title = "missing samples",
                                    source =
                                        "two-state Markov chain of lost packets: E. N. Gilbert, \"Capacity "
                                        "of a burst-noise channel\", Bell Syst. Tech. J. 39 (1960)";
  static constexpr Slot slot = Slot::measurement;
  static constexpr std::string_view description = R"(
  valid --( rate dt )--> missing --( dt / length )--> valid          probability per sample, dt apart

  A missing sample loses V, I and df together (NaN). A gap is at least one sample long, and another may
  begin within it. The first sample is valid.
)";
  enum P { rate, length };
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from = literature::own("more and longer gaps than in any usable record");
  static constexpr Parameter parameters[] = {
      {"rate", "lambda", "1/s", 0.0, 0.0, 100.0, 0.0, "gaps per second of valid record"},
      {"length", "L", "s", 0.1, 1e-3, 60.0, kNoNullValue, "mean length of a gap",
       literature::own("six samples at 60 samples/s")}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    if (!(p[rate] >= 0))
      problems.add(fmt::format("rate = {:g} 1/s", p[rate]), where, "a rate cannot be negative",
                   "give 0 or more");
    if (!(p[length] > 0))
      problems.add(fmt::format("length = {:g} s", p[length]), where, "a gap needs a length",
                   "give length > 0");
  }

  static constexpr std::uint32_t kStream = 11;  ///< random-number stream, distinct from those of NOISE

  static void measure(const double* p, std::uint64_t seed, Phasors& phasors) {
    constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
    bool missing = false;
    for (std::size_t k = 1; k < phasors.V.size(); ++k) {
      const auto u = uniform_pair(seed, kStream, k);
      const bool begins = u[0] < p[rate] / phasors.rate, ends = u[1] < 1.0 / (p[length] * phasors.rate);
      missing = begins || (missing && !ends);
      if (!missing) continue;
      phasors.V[k] = phasors.I[k] = {kMissing, kMissing};
      if (k < phasors.df.size()) phasors.df[k] = kMissing;
    }
  }
};

}  // namespace swingbank::sim::effects::measurement_gaps
