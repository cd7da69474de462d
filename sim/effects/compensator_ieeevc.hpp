#pragma once
// IEEEVC: load compensation of the regulated voltage.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::compensator_ieeevc {

struct Model {
  static constexpr std::string_view name = "IEEEVC", title = "load compensation (line drop, reactive droop)",
                                    source = "IEEE Std 421.5-2005, clause 4; PSS/E IEEEVC",
                                    dyr_name = "IEEEVC";
  static constexpr Slot slot = Slot::compensator;
  static constexpr std::string_view description = R"(
  Vc = |V + (RC + j XC) I|      V, I: voltage and current out of the machine, on its own base
  XC > 0: droop, a machine that shares reactive power; XC < 0: regulates a point behind part of the transformer
)";
  enum P { RC, XC };
  static constexpr Source defaults_from =
      literature::own("no resistance; half the reactance of the default step-up transformer");
  static constexpr Source bounds_from =
      literature::own("half of the 1 pu at which the compensated voltage vanishes");
  static constexpr Parameter parameters[] = {
      {"RC", "RC", "pu", 0.0, -0.5, 0.5, 0.0, "compensating resistance"},
      {"XC", "XC", "pu", 0.05, -0.5, 0.5, 0.0, "compensating reactance"}};
  static constexpr int dyr_columns[] = {RC, XC};
  enum C { r, x_, coefficients };

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    for (int i : {RC, XC})
      values.refuse(!(p[i] > -1.0 && p[i] < 1.0), i,
                    "at rated current the compensated voltage would vanish or double",
                    "give it on the machine's base, between -1 and 1 pu");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[r] = p[RC];
    c[x_] = p[XC];
  }
  template <class T>
  static void evaluate(const T* c, const T*, Signals<T>& s, T*) {
    using std::sqrt;
    const T re = s.Vr + c[r] * s.Ir - c[x_] * s.Ii, im = s.Vi + c[r] * s.Ii + c[x_] * s.Ir;
    s.Vc = sqrt(re * re + im * im);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T*) {
    evaluate<T>(c, nullptr, s, nullptr);
    return {};
  }
};

}  // namespace swingbank::sim::effects::compensator_ieeevc
