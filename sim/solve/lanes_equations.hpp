#pragma once
// Lanes: one evaluation of the whole grid, and of what is recorded.
#include "sim/solve/lanes.hpp"

namespace swingbank::sim {

template <class T>
inline void Lanes<T>::emfs(const T* x) {
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    const PlantSlice& p = plants_[i];
    p.equations.emf(&c_[static_cast<std::size_t>(p.c)], x + p.x, &m_[static_cast<std::size_t>(p.m)], er_[i], ei_[i]);
  }
}

/// Current of one plant on its own base: row `plant` of (G + jB) E.
template <class T>
inline void Lanes<T>::current(int plant, Signals<T>& s) const {
  const T* g = &g_[static_cast<std::size_t>(plant) * static_cast<std::size_t>(n_)];
  const T* b = &b_[static_cast<std::size_t>(plant) * static_cast<std::size_t>(n_)];
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
}

template <class T>
inline void Lanes<T>::derivative(const T* x, T* dx) {
  emfs(x);
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    const PlantSlice& p = plants_[i];
    Signals<T> s;
    current(static_cast<int>(i), s);
    s.Efd = efd_[i];
    s.Tm = tm_[i];
    const T* c = &c_[static_cast<std::size_t>(p.c)];
    T* m = &m_[static_cast<std::size_t>(p.m)];
    if (p.equations.has_controls()) {
      PlantEquations<T>::voltage(er_[i], ei_[i], r_[i], xs_[i], s);
      p.equations.derivative(c, x + p.x, m, s, dx + p.x);
    } else {
      p.equations.machine_derivative(c, x + p.x, m, s, dx + p.x);
    }
  }
}

/// Evaluates the recorded channels at states x and appends them to the record of every lane in `valid`.
template <class T>
inline void Lanes<T>::sample_outputs(const T* x, unsigned valid) {
  emfs(x);
  T* unused = unused_.data();
  const auto good = Traits::mask(valid);
  for (std::size_t k = 0; k < recorded_.size(); ++k) {
    const auto i = static_cast<std::size_t>(recorded_[k]);
    const PlantSlice& p = plants_[i];
    Signals<T> s;
    current(recorded_[k], s);
    s.Efd = efd_[i];
    s.Tm = tm_[i];
    PlantEquations<T>::voltage(er_[i], ei_[i], r_[i], xs_[i], s);
    PlantEquations<T>::terminal(s);
    p.equations.signals(&c_[static_cast<std::size_t>(p.c)], x + p.x, &m_[static_cast<std::size_t>(p.m)], s, unused + p.x);
    for (std::size_t j = 0; j < channels_.size(); ++j) {
      T v(0.0);
      switch (channels_[j]) {
        case Channel::delta: v = x[p.x]; break;
        case Channel::speed: v = s.speed; break;
        case Channel::P: v = s.P; break;
        case Channel::Q: v = s.Q; break;
        case Channel::V: v = s.V; break;
        case Channel::Efd: v = s.Efd; break;
        case Channel::Ifd: v = s.Ifd; break;
        case Channel::Tm: v = s.Tm; break;
        case Channel::theta: {
          using std::atan2;
          const T two_pi(6.28318530717958647692);
          const T angle = atan2(s.Vi, s.Vr);
          const T unwrapped = angle + two_pi * round_nearest((theta_[i] - angle) / two_pi);
          v = select(grounded_[i] > T(0.0), theta_[i], unwrapped);
          theta_[i] = select(good, v, theta_[i]);
          break;
        }
      }
      outputs_[k * channels_.size() + j] = v;
    }
  }
  const double* out = reinterpret_cast<const double*>(outputs_.data());
  for (int l = 0; l < kLanes; ++l)
    if ((valid >> l) & 1U) {
      auto& run = lanes_[static_cast<std::size_t>(l)];
      run.stage.put(out + l, kLanes, run.record);
    }
}

}  // namespace swingbank::sim
