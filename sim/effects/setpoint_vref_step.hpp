#pragma once
// VREFSTEP: step of the exciter's reference.
#include <fmt/format.h>

#include <algorithm>

#include "sim/core/drive.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::setpoint_vref_step {

struct Model {
  static constexpr std::string_view name = "VREFSTEP", title = "step of the exciter's reference",
                                    source = "disturbance drive: no model explains it; shape by definition";
  static constexpr Slot slot = Slot::setpoint;
  static constexpr std::string_view description = R"(
            amount |       ______
  dVref :         0 |______|      |______
                          t1     t2
  Before t1 and from t2 on exactly zero.
)";
  enum P { amount, start, end };
  static constexpr Parameter parameters[] = {
      {"amount", "dVref", "pu", 0.0, -0.5, 0.5, 0.0, "how far the reference of the exciter is moved"},
      {"start", "t1", "s", 1.0, 0.0, 1e5, kNoNeutral, "when the step comes"},
      {"end", "t2", "s", 1e5, 0.0, 1e5, kNoNeutral, "when it goes (100000: never)"}};
  enum C { coefficients = end + 1 };

  static void check(const double* p, const std::string& where, Problems& problems) {
    if (!(p[start] >= 0))
      problems.add(fmt::format("start = {:g} s", p[start]), where, "a run begins at 0 s", "give start >= 0");
    if (!(p[end] > p[start]))
      problems.add(fmt::format("end = {:g} s with start = {:g} s", p[end], p[start]), where,
                   "a step ends after it came", "give end > start");
  }
  static std::string_view unphysical(const double*) { return ""; }
  static std::vector<double> instants(const double* p) { return {p[start], p[end]}; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    std::copy(p, p + coefficients, c);
  }
  template <class T>
  static void evaluate(const T* c, const T*, Signals<T>& s, T*) {
    s.dVref = s.dVref + between(s.t, c[start], c[end], c[amount]);
  }
  template <class T>
  static std::string steady(const T*, T*, Signals<T>&, T*) {
    return {};
  }
};

}  // namespace swingbank::sim::setpoint_vref_step
