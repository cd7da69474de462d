#pragma once
// FORCEDOSC: forced oscillation of the mechanical torque.
#include <fmt/format.h>

#include "base/constants.hpp"
#include "sim/core/disturbance.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::shaft_forced_oscillation {

struct Model {
  static constexpr std::string_view name = "FORCEDOSC", title = "forced oscillation of the mechanical torque",
                                    source =
                                        "a disturbance; NERC, Forced Oscillation Monitoring and "
                                        "Mitigation (2017); sine by definition";
  static constexpr Slot slot = Slot::shaft;
  static constexpr std::string_view description = R"(
  Tm = Tm(governor) + amplitude sin(2 pi frequency (t - start) + phase)      start <= t < end
  The torque is unchanged before `start` and from `end` on.
)";
  enum P { amplitude, frequency, phase, start, end };
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from = shared::kAnyTime;
  static constexpr Parameter parameters[] = {
      {"amplitude", "A", "pu", 0.0, -1.0, 1.0, 0.0, "amplitude of the torque", kAsEffect, shared::kRating},
      {"frequency", "f", "Hz", 0.5, 1e-3, 60.0, kNoNullValue, "frequency of the oscillation",
       literature::own("an inter-area mode"), literature::own("from minutes to the frequency of the grid")},
      {"phase", "phi", "rad", 0.0, -constants::turn, constants::turn, kNoNullValue, "phase at `start`",
       literature::derived("a sine"), literature::derived("a turn either way")},
      {"start", "t1", "s", 1.0, 0.0, 1e5, kNoNullValue, "start of the oscillation", shared::kAfterRest},
      {"end", "t2", "s", 1e5, 0.0, 1e5, kNoNullValue, "end of the oscillation (100000: never)",
       shared::kNever}};
  enum C { kA, w, phi, t1, t2, coefficients };

  static void check(const double* p, const std::string& where, Problems& problems) {
    if (!(p[frequency] > 0))
      problems.add(fmt::format("frequency = {:g} Hz", p[frequency]), where, "an oscillation has a period",
                   "give frequency > 0");
    if (!(p[start] >= 0))
      problems.add(fmt::format("start = {:g} s", p[start]), where, "a run begins at 0 s", "give start >= 0");
    if (!(p[end] > p[start]))
      problems.add(fmt::format("end = {:g} s with start = {:g} s", p[end], p[start]), where,
                   "an oscillation ends after its start", "give end > start");
  }
  static std::vector<double> switching_times(const double* p) { return {p[start], p[end]}; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[kA] = p[amplitude];
    c[w] = T(constants::turn) * p[frequency];
    c[phi] = p[phase];
    c[t1] = p[start];
    c[t2] = p[end];
  }
  template <class T>
  static void evaluate(const T* c, const T*, Signals<T>& s, T*) {
    T sine, unused;
    sincos(c[w] * (s.t - c[t1]) + c[phi], sine, unused);
    s.Tm = s.Tm + between(s.t, c[t1], c[t2], c[kA] * sine);
  }
  template <class T>
  static std::string steady(const T*, T*, Signals<T>&, T*) {
    return {};
  }
};

}  // namespace swingbank::sim::effects::shaft_forced_oscillation
