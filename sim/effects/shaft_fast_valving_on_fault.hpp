#pragma once
// FVFAULT: fast valving triggered by a fault.
#include <fmt/format.h>

#include <algorithm>

#include "sim/core/blocks.hpp"
#include "sim/core/disturbance.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::shaft_fast_valving_on_fault {

struct Model {
  static constexpr std::string_view
      name = "FVFAULT",
      title = "fast valving triggered by a fault",
      source =
          "Kundur (1994), 17.1.5: intercept valves close within 0.1 to 0.2 s once a "
          "fault is detected, and reopen over seconds; ramps by definition, the "
          "detector is our own";
  static constexpr Slot slot = Slot::shaft;
  static constexpr std::string_view description = R"(
  Tm = Tm(governor) (1 - drop g(since))

        1 |        ______
  g:      |       /      \____
        0 |______/            \_________
             delay +closing +hold  +opening

  d set/dt   = 100 clamp((V0 - V)/dip - 1, 0, 1) (1 - set)     V0: steady-state V
  d since/dt = set
  Until V has fallen by `dip` nothing is changed.
)";
  enum P { drop, dip, delay, closing, hold, opening };
  static constexpr Source defaults_from =
      literature::own("a noticeable fault, and a short delay of the valves");
  static constexpr Source bounds_from = shared::kAnyTime;
  static constexpr Parameter parameters[] = {
      {"drop", "k", "-", 0.3, 0.0, 1.0, 0.0, "fraction of the torque removed by the valves",
       literature::own("30 % of the torque, a visible effect"), shared::kShare},
      {"dip", "dV", "pu", 0.1, 1e-3, 2.0, kNoNullValue, "voltage dip that triggers the valves",
       literature::own("more than a load step causes"), literature::own("from noise to more than V")},
      {"delay", "t1", "s", 0.1, 0.0, 1e5, kNoNullValue,
       "time from the fault until the valves begin to close"},
      {"closing", "Tc", "s", 0.15, 1e-3, 100.0, kNoNullValue, "closing time",
       literature::kundur("17.1.5, 0.1 to 0.2 s"), literature::own("longer than any valve takes")},
      {"hold", "Th", "s", 0.2, 0.0, 1e5, kNoNullValue, "time for which the valves stay closed",
       literature::own("slightly longer than the closing")},
      {"opening", "To", "s", 3.0, 1e-3, 1e5, kNoNullValue, "reopening time",
       literature::kundur("17.1.5, over seconds")}};
  enum C { begins = opening + 1, level, coefficients };
  enum X { set, since };
  static constexpr State states[] = {{"set", "-", "1 after the detection of a fault", 1.0},
                                     {"since", "s", "time since the detection", 1.0}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    for (const P i : {dip, closing, opening})
      if (!(p[i] > 0))
        problems.add(fmt::format("{} = {:g} {}", parameters[i].name, p[i], parameters[i].unit), where,
                     "the equations divide by it", fmt::format("give {} > 0", parameters[i].name));
    for (const P i : {delay, hold})
      if (!(p[i] >= 0))
        problems.add(fmt::format("{} = {:g} s", parameters[i].name, p[i]), where, "a time cannot be negative",
                     fmt::format("give {} >= 0", parameters[i].name));
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    std::copy(p, p + opening + 1, c);
    c[begins] = p[delay] + p[closing] + p[hold];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T fallen = clamp((c[level] - s.V) / c[dip] - T(1.0), T(0.0), T(1.0));
    dx[set] = T(100.0) * fallen * (T(1.0) - x[set]);
    dx[since] = x[set];
    const T shape = ramp(x[since], c[delay], c[closing]) - ramp(x[since], c[begins], c[opening]);
    s.Tm = s.Tm - s.Tm * c[drop] * shape;
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    c[level] = s.V;
    x[set] = x[since] = T(0.0);
    return {};
  }
};

}  // namespace swingbank::sim::effects::shaft_fast_valving_on_fault
