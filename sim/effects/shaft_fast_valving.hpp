#pragma once
// FASTVALVE: fast valving, a temporary closure of the turbine's intercept valves.
#include <fmt/format.h>

#include <algorithm>

#include "sim/core/disturbance.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::shaft_fast_valving {

struct Model {
  static constexpr std::string_view name = "FASTVALVE", title = "fast valving",
                                    source =
                                        "Kundur (1994), 17.1.5: intercept valves close within 0.1 to 0.2 s "
                                        "and reopen over seconds; ramps by definition";
  static constexpr Slot slot = Slot::shaft;
  static constexpr std::string_view description = R"(
  Tm = Tm(governor) (1 - drop g(t))

        1 |        ______
  g(t):   |       /      \____
        0 |______/            \_________
             start  +closing  +hold  +opening
  The torque is unchanged before `start`.
)";
  enum P { drop, start, closing, hold, opening };
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from = shared::kAnyTime;
  static constexpr Parameter parameters[] = {
      {"drop", "k", "-", 0.0, 0.0, 1.0, 0.0, "fraction of the torque removed by the valves", kAsEffect,
       shared::kShare},
      {"start", "t1", "s", 1.0, 0.0, 1e5, kNoNullValue, "start of the closing", shared::kAfterRest},
      {"closing", "Tc", "s", 0.15, 0.0, 100.0, kNoNullValue, "closing time (0: instantaneous)",
       literature::kundur("17.1.5, 0.1 to 0.2 s"), literature::own("longer than any valve takes")},
      {"hold", "Th", "s", 0.2, 0.0, 1e5, kNoNullValue, "time for which the valves stay closed",
       literature::own("slightly longer than the closing")},
      {"opening", "To", "s", 3.0, 0.0, 1e5, kNoNullValue, "reopening time (0: instantaneous)",
       literature::kundur("17.1.5, over seconds")}};
  enum C { coefficients = opening + 1 };

  static void check(const double* p, const std::string& where, Problems& problems) {
    for (const P i : {start, closing, hold, opening})
      if (!(p[i] >= 0))
        problems.add(fmt::format("{} = {:g} s", parameters[i].name, p[i]), where, "a time cannot be negative",
                     fmt::format("give {} >= 0", parameters[i].name));
  }
  static std::vector<double> switching_times(const double* p) {
    const double closed = p[start] + p[closing], opens = closed + p[hold];
    return {p[start], closed, opens, opens + p[opening]};
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    std::copy(p, p + coefficients, c);
  }
  template <class T>
  static void evaluate(const T* c, const T*, Signals<T>& s, T*) {
    const T opens = c[start] + c[closing] + c[hold];
    const T shape = ramp(s.t, c[start], c[closing]) - ramp(s.t, opens, c[opening]);
    s.Tm = s.Tm - s.Tm * c[drop] * shape;
  }
  template <class T>
  static std::string steady(const T*, T*, Signals<T>&, T*) {
    return {};
  }
};

}  // namespace swingbank::sim::effects::shaft_fast_valving
