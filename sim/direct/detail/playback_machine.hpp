#pragma once
// Equations of a machine with played-in terminal voltage, evaluated at one time. Efd and mechanical torque
// keep their values of the steady state before the event.
#include <array>
#include <vector>

#include "sim/core/effect.hpp"
#include "sim/direct/detail/noisy_record.hpp"

namespace swingbank::sim::direct {

/// Machine behind a constant impedance. Angles are relative to the terminal voltage.
template <class T>
struct PlaybackMachine {
  const Ops<T>& ops;
  std::vector<T> c, scratch;
  /// States, to be set before evaluate(); initially the steady state. States that the machine does not have
  /// are zero, as are their derivatives.
  std::array<T, kMostFlowing> x{}, dx{};
  Signals<T> s;
  T r, xm;  ///< impedance between terminal and internal voltage [pu]

  /// Initialises the steady state with terminal voltage V0 and current Ir0 + j Ii0 out of the machine [pu].
  PlaybackMachine(const Effect& effect, const Conventions& conventions, const std::vector<T>& p, const T& V0,
                  const T& Ir0, const T& Ii0)
      : ops(effect.get<T>()),
        c(static_cast<std::size_t>(effect.coefficients)),
        scratch(static_cast<std::size_t>(effect.scratch)) {
    ops.prepare(p.data(), conventions, c.data());
    ops.machine.source_impedance(p.data(), r, xm);
    s.Vr = V0;
    s.Ir = Ir0;
    s.Ii = Ii0;
    ops.machine.steady(p.data(), c.data(), s, x.data());
  }
  /// Computes the current at terminal voltage V and the signals that follow from it.
  void evaluate(const T& V) {
    T er, ei;
    ops.machine.emf(c.data(), x.data(), scratch.data(), er, ei);
    const T dr = er - V, k = T(1.0) / (r * r + xm * xm);
    s.Vr = V;
    s.Ir = (r * dr + xm * ei) * k;
    s.Ii = (r * ei - xm * dr) * k;
    ops.machine.electrical(c.data(), x.data(), scratch.data(), s);
  }
  /// Computes dx, after evaluate().
  void derive() { ops.machine.derivative(c.data(), x.data(), scratch.data(), s, dx.data()); }
};

/// Performs one step of the classical fourth-order Runge-Kutta method from x. `first`: derivative at x;
/// derivative(stage, y) returns the derivatives in the middle (stages 1 and 2) and at the end (3).
template <class Vector, class Derivative>
void runge_kutta(Vector& x, const Vector& first, double h, const Derivative& derivative) {
  using T = typename Vector::value_type;
  const auto moved = [&](const Vector& by, double share) {
    Vector y = x;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = y[i] + T(share) * by[i];
    return y;
  };
  const auto b = derivative(1, moved(first, h / 2));
  const auto c = derivative(2, moved(b, h / 2));
  const auto d = derivative(3, moved(c, h));
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = x[i] + T(h / 6) * (first[i] + T(2.0) * (b[i] + c[i]) + d[i]);
}

}  // namespace swingbank::sim::direct
