#pragma once
// Batch kernel: evaluation of the grid's equations.
#include "sim/batch/detail/batch_kernel.hpp"

namespace swingbank::sim::batch {

template <class T>
inline void BatchKernel<T>::emfs(Constants& k, const T* x) {
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    const PlantSlice& p = plants_[i];
    p.equations.emf(&k.c[static_cast<std::size_t>(p.c)], x + p.x, &m_[static_cast<std::size_t>(p.m)], er_[i],
                    ei_[i]);
  }
  if (!nonlinear_.empty()) solve_algebra(k, x);
}

/// Computes the current of one source on its own base, row `source` of (G + jB) E, and sets the plant's
/// inputs.
template <class T>
inline void BatchKernel<T>::current(const Constants& k, std::size_t source, Signals<T>& s) const {
  const T* g = &k.g[source * static_cast<std::size_t>(sources_)];
  const T* b = &k.b[source * static_cast<std::size_t>(sources_)];
  row_times(g, b, er_.data(), ei_.data(), sources_, s.Ir, s.Ii);
  if (source < plants_.size()) inputs(k, source, s);
}

/// As current(), if all currents are already computed; `at` is the index of this plant's current.
template <class T>
inline void BatchKernel<T>::shared_current(std::size_t at, const Constants& k, std::size_t plant,
                                           Signals<T>& s) const {
  s.Ir = ir_[at];
  s.Ii = ii_[at];
  inputs(k, plant, s);
}

template <class T>
inline void BatchKernel<T>::inputs(const Constants& k, std::size_t plant, Signals<T>& s) const {
  s.Efd = k.efd[plant];
  s.Tm = k.tm[plant];
  s.dVref = k.dvref[plant];
  s.dPref = k.dpref[plant];
}

/// Evaluates the remote measurements of a plant's controls; call after voltages() of the plant.
template <class T>
inline void BatchKernel<T>::look_far(const Constants& k, const FarRows& rows, Signals<T>& s) const {
  const auto row = [&](int at, T& real, T& imaginary) {
    const std::size_t first = static_cast<std::size_t>(at) * static_cast<std::size_t>(sources_);
    row_times(&k.far_g[first], &k.far_b[first], er_.data(), ei_.data(), sources_, real, imaginary);
  };
  if (rows.voltage >= 0) row(rows.voltage, s.far.Vr, s.far.Vi);
  if (rows.near < 0) return;
  T vr, vi;
  row(rows.near, vr, vi);
  row(rows.current, s.far.Ir, s.far.Ii);
  s.far.P = vr * s.far.Ir + vi * s.far.Ii;
  s.far.Q = vi * s.far.Ir - vr * s.far.Ii;
}

template <class T>
inline void BatchKernel<T>::derivative(const T* x, T* dx) {
  Constants& k = per_lane_;
  Signals<T>& s = signals_;
  s.t = minimum(time_, k.last_moment);
  emfs(k, x);
  if (shares_) shared_.solve(er_.data(), ei_.data(), ir_.data(), ii_.data());
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    const PlantSlice& p = plants_[i];
    if (shares_)
      shared_current(i, k, i, s);
    else
      current(k, i, s);
    const T* c = &k.c[static_cast<std::size_t>(p.c)];
    T* m = &m_[static_cast<std::size_t>(p.m)];
    if (p.equations.machine_alone()) {
      p.equations.machine_derivative(c, x + p.x, m, s, dx + p.x);
    } else {
      p.equations.voltages(c, er_[i], ei_[i], s);
      if (far_count_ > 0) look_far(k, p.far, s);
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
    s.Vpr = s.Vr = er_[source] - z[0] * s.Ir + z[1] * s.Ii;
    s.Vpi = s.Vi = ei_[source] - z[0] * s.Ii - z[1] * s.Ir;
    l.equations.derivative(&k.c[static_cast<std::size_t>(l.c)], x + l.x, s, dx + l.x);
  }
}

}  // namespace swingbank::sim::batch
