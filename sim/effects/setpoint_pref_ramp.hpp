#pragma once
// PREFRAMP: ramp of the governor's reference.
#include <fmt/format.h>

#include <algorithm>

#include "sim/core/drive.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::setpoint_pref_ramp {

struct Model {
  static constexpr std::string_view name = "PREFRAMP", title = "ramp of the governor's reference",
                                    source = "disturbance drive: no model explains it; shape by definition";
  static constexpr Slot slot = Slot::setpoint;
  static constexpr std::string_view description = R"(
            amount |        ________
                   |       /
  dPref :         0 |______/
                        t1   t1 + T
  Before t1 exactly zero; stays at `amount` after t1 + T.
)";
  enum P { amount, start, duration };
  static constexpr Parameter parameters[] = {
      {"amount", "dPref", "pu", 0.0, -1.0, 1.0, 0.0, "how far the reference of the governor is moved"},
      {"start", "t1", "s", 1.0, 0.0, 1e5, kNoNeutral, "when the ramp begins"},
      {"duration", "T", "s", 5.0, 0.0, 1e5, kNoNeutral, "how long the ramp lasts (0: a step)"}};
  enum C { coefficients = duration + 1 };

  static void check(const double* p, const std::string& where, Problems& problems) {
    if (!(p[start] >= 0))
      problems.add(fmt::format("start = {:g} s", p[start]), where, "a run begins at 0 s", "give start >= 0");
    if (!(p[duration] >= 0))
      problems.add(fmt::format("duration = {:g} s", p[duration]), where, "a ramp goes forward in time",
                   "give duration >= 0");
  }
  static std::string_view unphysical(const double*) { return ""; }
  static std::vector<double> instants(const double* p) { return {p[start], p[start] + p[duration]}; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    std::copy(p, p + coefficients, c);
  }
  template <class T>
  static void evaluate(const T* c, const T*, Signals<T>& s, T*) {
    s.dPref = s.dPref + c[amount] * ramp(s.t, c[start], c[duration]);
  }
  template <class T>
  static std::string steady(const T*, T*, Signals<T>&, T*) {
    return {};
  }
};

}  // namespace swingbank::sim::setpoint_pref_ramp
