#pragma once
// Lanes: sources whose current is no linear function of the voltage - loads with a model of their own,
// machines with saliency, converters. Each is written as E = V + z I(V) behind its constant impedance z, so
// that the network stays I = (G + jB) E; the voltages V at these sources are found by Newton's method, every
// lane until it has converged and no further, so that no lane's bits depend on another's. V is the machine's
// own terminal: behind a step-up transformer of ratio n the network has n E, and the machine n I.
#include "sim/lanes/detail/lanes.hpp"

namespace swingbank::sim::lanes {

template <class T>
inline const T* Lanes<T>::source_impedance(const Constants& k, int source) const {
  if (source < n_) {
    const PlantSlice& p = plants_[static_cast<std::size_t>(source)];
    return p.equations.impedance(&k.c[static_cast<std::size_t>(p.c)]);
  }
  const LoadSlice& l = loads_[static_cast<std::size_t>(source - n_)];
  return l.equations.impedance(&k.c[static_cast<std::size_t>(l.c)]);
}

/// Of a machine without its step-up transformer.
template <class T>
inline const T* Lanes<T>::own_impedance(const Constants& k, int source) const {
  if (source >= n_) return source_impedance(k, source);
  const PlantSlice& p = plants_[static_cast<std::size_t>(source)];
  return p.equations.machine_impedance(&k.c[static_cast<std::size_t>(p.c)]);
}
/// Of a machine's step-up transformer; none: nullptr.
template <class T>
inline const T* Lanes<T>::ratio(const Constants& k, int source) const {
  if (source >= n_) return nullptr;
  const PlantSlice& p = plants_[static_cast<std::size_t>(source)];
  return p.equations.ratio(&k.c[static_cast<std::size_t>(p.c)]);
}

/// E = V + z I(V) of one nonlinear source, as the network has it.
template <class T>
void Lanes<T>::source_emf(const Constants& k, const T* x, int source, const T& vr, const T& vi, T& er,
                          T& ei) {
  Signals<T>& s = signals_;
  s.Vr = vr;
  s.Vi = vi;
  if (source < n_) {
    const PlantSlice& p = plants_[static_cast<std::size_t>(source)];
    p.equations.current(&k.c[static_cast<std::size_t>(p.c)], x + p.x, &m_[static_cast<std::size_t>(p.m)], s);
  } else {
    const LoadSlice& l = loads_[static_cast<std::size_t>(source - n_)];
    l.equations.current(&k.c[static_cast<std::size_t>(l.c)], x + l.x, s);
  }
  const T* z = own_impedance(k, source);
  er = vr + z[0] * s.Ir - z[1] * s.Ii;
  ei = vi + z[0] * s.Ii + z[1] * s.Ir;
  if (source < n_ && !plants_[static_cast<std::size_t>(source)].rotor) {
    const T& on = k.on[static_cast<std::size_t>(source)];  // a tripped converter has no voltage of its own
    er = er * on;
    ei = ei * on;
  }
  if (const T* n = ratio(k, source)) {
    er = er * *n;
    ei = ei * *n;
  }
}

/// Solves a x = b in place, no pivoting: the matrix is the identity plus what the nonlinear parts feed back.
template <class T>
void solve_dense(T* a, T* b, std::size_t n) {
  for (std::size_t p = 0; p < n; ++p) {
    const T inverse = T(1.0) / a[p * n + p];
    for (std::size_t i = p + 1; i < n; ++i) {
      const T factor = a[i * n + p] * inverse;
      for (std::size_t j = p + 1; j < n; ++j) a[i * n + j] = a[i * n + j] - factor * a[p * n + j];
      b[i] = b[i] - factor * b[p];
    }
  }
  for (std::size_t p = n; p-- > 0;) {
    for (std::size_t j = p + 1; j < n; ++j) b[p] = b[p] - a[p * n + j] * b[j];
    b[p] = b[p] / a[p * n + p];
  }
}

/// One Newton step of V - (E(V) - z (G + jB) E(V)) = 0, left in algebra_[0 .. 2K). dE/dV by differences:
/// their error only slows the convergence. Returns the largest component.
template <class T>
typename Lanes<T>::Flat Lanes<T>::newton_step(Constants& k, const T* x) {
  constexpr double nudge = 1e-6;  // [pu]
  const std::size_t count = nonlinear_.size(), size = 2 * count;
  T* f = algebra_.data();
  T* slope = f + size;  // dE/dV, four values per source
  T* a = slope + 4 * count;
  for (std::size_t j = 0; j < count; ++j) {
    const int source = nonlinear_[j];
    const auto at = static_cast<std::size_t>(source);
    T er, ei;
    source_emf(k, x, source, k.vr[j], k.vi[j], er_[at], ei_[at]);
    source_emf(k, x, source, k.vr[j] + T(nudge), k.vi[j], er, ei);
    slope[4 * j] = (er - er_[at]) * T(1.0 / nudge);
    slope[4 * j + 1] = (ei - ei_[at]) * T(1.0 / nudge);
    source_emf(k, x, source, k.vr[j], k.vi[j] + T(nudge), er, ei);
    slope[4 * j + 2] = (er - er_[at]) * T(1.0 / nudge);
    slope[4 * j + 3] = (ei - ei_[at]) * T(1.0 / nudge);
  }
  Signals<T>& s = signals_;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(nonlinear_[i]);
    const T* z = own_impedance(k, nonlinear_[i]);
    T zr = z[0], zi = z[1], er = er_[at], ei = ei_[at], share(1.0);
    if (const T* n = ratio(k, nonlinear_[i])) {
      share = T(1.0) / *n;
      er = er * share;
      ei = ei * share;
      zr = zr * *n;
      zi = zi * *n;
    }
    current(k, at, s);
    f[2 * i] = k.vr[i] - (er - zr * s.Ir + zi * s.Ii);
    f[2 * i + 1] = k.vi[i] - (ei - zr * s.Ii - zi * s.Ir);
    for (std::size_t j = 0; j < count; ++j) {
      const auto from = static_cast<std::size_t>(nonlinear_[j]);
      const T& g = k.g[at * static_cast<std::size_t>(sources_) + from];
      const T& b = k.b[at * static_cast<std::size_t>(sources_) + from];
      const double own = i == j ? 1.0 : 0.0;
      const T wr = (i == j ? share : T(0.0)) - (zr * g - zi * b), wi = T(0.0) - (zr * b + zi * g);  // dV/dE
      for (std::size_t side = 0; side < 2; ++side) {
        const T& dr = slope[4 * j + 2 * side];
        const T& di = slope[4 * j + 2 * side + 1];
        a[(2 * i) * size + 2 * j + side] = T(side == 0 ? own : 0.0) - (wr * dr - wi * di);
        a[(2 * i + 1) * size + 2 * j + side] = T(side == 1 ? own : 0.0) - (wr * di + wi * dr);
      }
    }
  }
  solve_dense(a, f, size);
  Flat largest(0.0);
  for (std::size_t i = 0; i < size; ++i) largest = maximum(absolute(Traits::value(f[i])), largest);
  return largest;
}

template <class T>
void Lanes<T>::solve_algebra(Constants& k, const T* x) {
  constexpr int limit = 40;
  constexpr double longest = 0.3;  // [pu]: a load of constant power may throw the first steps far
  constexpr double near = 1e-7;    // [pu]: a step this short leaves 1e-13 behind
  // Newton's last step still carries the slopes' error of the differences: duals take two more.
  constexpr int more = Traits::directions > 0 ? 2 : 0;
  auto seeking = Traits::mask((1U << kLanes) - 1U);
  unsigned open = (1U << kLanes) - 1U;
  std::array<int, kLanes> calm{};
  for (int step = 0; step < limit && open != 0; ++step) {
    const Flat largest = newton_step(k, x);
    const T scale = Traits::constant(Flat(longest) / maximum(Flat(longest), largest));
    for (std::size_t i = 0; i < nonlinear_.size(); ++i) {
      k.vr[i] = select(seeking, k.vr[i] - scale * algebra_[2 * i], k.vr[i]);
      k.vi[i] = select(seeking, k.vi[i] - scale * algebra_[2 * i + 1], k.vi[i]);
    }
    alignas(64) double size[kLanes];
    LaneTraits<Flat>::store(largest, size);
    for (int l = 0; l < kLanes; ++l)
      if (size[l] < near && calm[static_cast<std::size_t>(l)]++ >= more) open &= ~(1U << l);
    seeking = Traits::mask(open);
  }
  for (std::size_t i = 0; i < nonlinear_.size(); ++i) {
    const auto at = static_cast<std::size_t>(nonlinear_[i]);
    source_emf(k, x, nonlinear_[i], k.vr[i], k.vi[i], er_[at], ei_[at]);
    if (open == 0) continue;
    // No voltage was found: the step must not pass. The next search begins at the last sound voltage.
    const T none(std::numeric_limits<double>::quiet_NaN());
    er_[at] = select(seeking, none, er_[at]);
    const auto lost = seeking;
    k.vr[i] = select(lost, T(1.0), k.vr[i]);
    k.vi[i] = select(lost, T(0.0), k.vi[i]);
  }
}

}  // namespace swingbank::sim::lanes
