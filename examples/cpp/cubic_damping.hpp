#pragma once
// CUBEDAMP: damping proportional to the cube of the speed deviation, an effect that Swingbank lacks.
#include "sim/core/effect.hpp"

namespace example {

using namespace swingbank::sim;

struct CubicDamping {  // Tm = Tm - K w^3 (w: speed deviation)
  static constexpr std::string_view name = "CUBEDAMP", title = "cubic damping", source = "example",
                                    description = "Tm = Tm - K w^3";
  static constexpr Slot slot = Slot::shaft;
  static constexpr Source defaults_from = literature::own("example"), bounds_from = defaults_from;
  static constexpr Parameter parameters[] = {{"K", "K", "pu", 1e6, 0, 1e9, 0, "torque at w = 1"}};
  enum { coefficients = 1 };
  static void check(const double*, const std::string&, swingbank::Problems&) {}
  static std::string_view unphysical(const double*) { return {}; }
  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[0] = p[0];
  }
  template <class T>
  static void evaluate(const T* c, const T*, Signals<T>& s, T*) {
    s.Tm = s.Tm - c[0] * s.speed * s.speed * s.speed;
  }
  template <class T>
  static std::string steady(const T*, T*, Signals<T>&, T*) {
    return {};
  }
};

}  // namespace example
