#pragma once
// Lanes: one evaluation of the whole grid.
#include "sim/solve/lanes.hpp"

namespace swingbank::sim {

template <class T>
inline void Lanes<T>::emfs(const Constants& k, const T* x) {
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    const PlantSlice& p = plants_[i];
    p.equations.emf(&k.c[static_cast<std::size_t>(p.c)], x + p.x, &m_[static_cast<std::size_t>(p.m)], er_[i],
                    ei_[i]);
  }
}

/// Current of one plant on its own base: row `plant` of (G + jB) E.
template <class T>
inline void Lanes<T>::current(const Constants& k, std::size_t plant, Signals<T>& s) const {
  const T* g = &k.g[plant * static_cast<std::size_t>(n_)];
  const T* b = &k.b[plant * static_cast<std::size_t>(n_)];
  const T* er = er_.data();
  const T* ei = ei_.data();
  T gr = g[0] * er[0], gi = g[0] * ei[0], bi = b[0] * ei[0], br = b[0] * er[0];
  for (int j = 1; j < n_; ++j) {
    gr = gr + g[j] * er[j];
    gi = gi + g[j] * ei[j];
    bi = bi + b[j] * ei[j];
    br = br + b[j] * er[j];
  }
  s.Ir = gr - bi;
  s.Ii = gi + br;
  s.Efd = k.efd[plant];
  s.Tm = k.tm[plant];
}

template <class T>
inline void Lanes<T>::derivative(const T* x, T* dx) {
  const Constants& k = per_lane_;
  Signals<T>& s = signals_;
  emfs(k, x);
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    const PlantSlice& p = plants_[i];
    current(k, i, s);
    const T* c = &k.c[static_cast<std::size_t>(p.c)];
    T* m = &m_[static_cast<std::size_t>(p.m)];
    if (p.equations.has_controls()) {
      PlantEquations<T>::voltage(er_[i], ei_[i], k.r[i], k.xs[i], s);
      p.equations.derivative(c, x + p.x, m, s, dx + p.x);
    } else {
      p.equations.machine_derivative(c, x + p.x, m, s, dx + p.x);
    }
  }
}

}  // namespace swingbank::sim
