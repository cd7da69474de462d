#pragma once
// Single-precision equations of effects, limited to those that an integration step evaluates. Operating
// points and coefficients are computed in double.
#include "sim/core/effect.hpp"
#include "sim/core/float_pack.hpp"

namespace swingbank::sim {

/// Whether single-precision equations exist: true for compiled effects, false for user-defined models.
bool has_float_ops(const Effect& effect);
/// Returns the single-precision equations. Requires has_float_ops(). CMake generates the definition together
/// with the registry of effects.
template <>
const Ops<FloatPack>& Effect::get<FloatPack>() const;

// ---- used by the generated table only ----------------------------------------------------------------
/// \cond
template <class M>
Ops<FloatPack> make_float_ops() {
  using T = FloatPack;
  Ops<T> o;
  if constexpr (M::slot == Slot::machine) {
    o.machine.emf = &M::template emf<T>;
    o.machine.electrical = &M::template electrical<T>;
    o.machine.derivative = &M::template derivative<T>;
    if constexpr (requires { &M::template current<T>; }) o.machine.current = &M::template current<T>;
  } else if constexpr (is_control(M::slot)) {
    o.control.evaluate = +[](const void*, const T* c, const T* x, Signals<T>& s, T* dx) {
      M::template evaluate<T>(c, x, s, dx);
    };
    if constexpr (requires { &M::template publish<T>; }) o.control.publish = &M::template publish<T>;
    if constexpr (requires { &M::template afterwards<T>; }) o.control.afterwards = &M::template afterwards<T>;
  }
  return o;
}
/// \endcond

}  // namespace swingbank::sim
