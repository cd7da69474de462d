#pragma once
// Lanes: one evaluation of the whole grid.
#include "sim/solve/lanes.hpp"

namespace swingbank::sim {

template <class T>
inline void Lanes<T>::emfs(Constants& k, const T* x) {
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    const PlantSlice& p = plants_[i];
    p.equations.emf(&k.c[static_cast<std::size_t>(p.c)], x + p.x, &m_[static_cast<std::size_t>(p.m)], er_[i],
                    ei_[i]);
  }
  if (!nonlinear_.empty()) solve_algebra(k, x);
}

/// Current of one source on its own base: row `source` of (G + jB) E; and what the event brings to a plant.
template <class T>
inline void Lanes<T>::current(const Constants& k, std::size_t source, Signals<T>& s) const {
  const T* g = &k.g[source * static_cast<std::size_t>(sources_)];
  const T* b = &k.b[source * static_cast<std::size_t>(sources_)];
  const T* er = er_.data();
  const T* ei = ei_.data();
  T gr = g[0] * er[0], gi = g[0] * ei[0], bi = b[0] * ei[0], br = b[0] * er[0];
  for (int j = 1; j < sources_; ++j) {
    gr = gr + g[j] * er[j];
    gi = gi + g[j] * ei[j];
    bi = bi + b[j] * ei[j];
    br = br + b[j] * er[j];
  }
  s.Ir = gr - bi;
  s.Ii = gi + br;
  if (source >= plants_.size()) return;
  s.Efd = k.efd[source];
  s.Tm = k.tm[source];
  s.dVref = k.dvref[source];
  s.dPref = k.dpref[source];
}

template <class T>
inline void Lanes<T>::derivative(const T* x, T* dx) {
  Constants& k = per_lane_;
  Signals<T>& s = signals_;
  s.t = minimum(time_, k.last_moment);
  emfs(k, x);
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    const PlantSlice& p = plants_[i];
    current(k, i, s);
    const T* c = &k.c[static_cast<std::size_t>(p.c)];
    T* m = &m_[static_cast<std::size_t>(p.m)];
    if (p.equations.machine_alone()) {
      p.equations.machine_derivative(c, x + p.x, m, s, dx + p.x);
    } else {
      p.equations.voltages(c, er_[i], ei_[i], s);
      p.equations.derivative(c, x + p.x, m, s, dx + p.x);
      if (p.watch >= 0) watch_stage(watched_[static_cast<std::size_t>(p.watch)], s.Vs);
    }
    if (tripped_ != 0)
      for (int j = 0; j < p.equations.states(); ++j) dx[p.x + j] = dx[p.x + j] * k.on[i];
  }
  for (std::size_t i = 0; i < loads_.size(); ++i) {
    const LoadSlice& l = loads_[i];
    if (l.equations.states() == 0) continue;
    const std::size_t source = plants_.size() + i;
    current(k, source, s);
    const T* z = source_impedance(k, static_cast<int>(source));
    s.Vr = er_[source] - z[0] * s.Ir + z[1] * s.Ii;
    s.Vi = ei_[source] - z[0] * s.Ii - z[1] * s.Ir;
    l.equations.derivative(&k.c[static_cast<std::size_t>(l.c)], x + l.x, s, dx + l.x);
  }
}

}  // namespace swingbank::sim
