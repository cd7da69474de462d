#pragma once
// Batch kernel: sources whose current is a nonlinear function of the voltage (loads with a dynamic model,
// machines with saliency, converters). Each is represented by E = V + z I(V) behind its constant impedance z,
// so that the network equation remains I = (G + jB) E. Newton's method solves for the voltages V at these
// sources. Each lane stops when its own voltages have converged, so that its result is bitwise independent of
// the other lanes. V is the voltage at the machine's terminal. With a step-up transformer of ratio n, the
// source voltage in the network is n E, and the machine's current is n times the network current I.
#include "sim/batch/detail/batch_kernel.hpp"

namespace swingbank::sim::batch {

template <class T>
inline const T* BatchKernel<T>::source_impedance(const Constants& k, int source) const {
  if (source < n_) {
    const PlantSlice& p = plants_[static_cast<std::size_t>(source)];
    return p.equations.impedance(&k.c[static_cast<std::size_t>(p.c)]);
  }
  const LoadSlice& l = loads_[static_cast<std::size_t>(source - n_)];
  return l.equations.impedance(&k.c[static_cast<std::size_t>(l.c)]);
}

/// Returns a source's impedance without its step-up transformer [pu on its own base].
template <class T>
inline const T* BatchKernel<T>::own_impedance(const Constants& k, int source) const {
  if (source >= n_) return source_impedance(k, source);
  const PlantSlice& p = plants_[static_cast<std::size_t>(source)];
  return p.equations.machine_impedance(&k.c[static_cast<std::size_t>(p.c)]);
}
/// Returns the ratio of a machine's step-up transformer, or nullptr if it has none.
template <class T>
inline const T* BatchKernel<T>::ratio(const Constants& k, int source) const {
  if (source >= n_) return nullptr;
  const PlantSlice& p = plants_[static_cast<std::size_t>(source)];
  return p.equations.ratio(&k.c[static_cast<std::size_t>(p.c)]);
}

/// Computes E = V + z I(V) of one nonlinear source, referred to the network.
template <class T>
void BatchKernel<T>::source_emf(const Constants& k, const T* x, int source, const T& vr, const T& vi, T& er,
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
    const T& on = k.on[static_cast<std::size_t>(source)];  // a tripped converter has E = 0
    er = er * on;
    ei = ei * on;
  }
  if (const T* n = ratio(k, source)) {
    er = er * *n;
    ei = ei * *n;
  }
}

/// Computes triangular factors in place. It does not pivot, because the matrix is the identity plus the
/// feedback of the nonlinear sources.
template <class T>
void factor_dense(T* a, std::size_t n) {
  for (std::size_t p = 0; p < n; ++p) {
    const T inverse = T(1.0) / a[p * n + p];
    a[p * n + p] = inverse;
    for (std::size_t i = p + 1; i < n; ++i) {
      const T factor = a[i * n + p] * inverse;
      a[i * n + p] = factor;
      for (std::size_t j = p + 1; j < n; ++j) a[i * n + j] = a[i * n + j] - factor * a[p * n + j];
    }
  }
}

/// Solves a x = b in place with the factors of a.
template <class T>
void solve_factored(const T* a, T* b, std::size_t n) {
  for (std::size_t i = 1; i < n; ++i) {
    T sum = b[i];
    for (std::size_t j = 0; j < i; ++j) sum = sum - a[i * n + j] * b[j];
    b[i] = sum;
  }
  for (std::size_t i = n; i-- > 0;) {
    T sum = b[i];
    for (std::size_t j = i + 1; j < n; ++j) sum = sum - a[i * n + j] * b[j];
    b[i] = sum * a[i * n + i];
  }
}

/// Computes the residual of V - (E(V) - z (G + jB) E(V)) = 0 into algebra_[0 .. 2K), for K nonlinear sources.
/// `steady`: currents that the linear sources cause at the nonlinear ones.
template <class T>
void BatchKernel<T>::algebra_rest(Constants& k, const T* x, const T* steady) {
  const std::size_t count = nonlinear_.size();
  T* f = algebra_.data();
  for (std::size_t j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(nonlinear_[j]);
    source_emf(k, x, nonlinear_[j], k.vr[j], k.vi[j], er_[at], ei_[at]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(nonlinear_[i]);
    const T *g = &k.g[at * static_cast<std::size_t>(sources_)],
            *b = &k.b[at * static_cast<std::size_t>(sources_)];
    T ir = steady[2 * i], ii = steady[2 * i + 1];
    for (const int source : nonlinear_) {
      const auto from = static_cast<std::size_t>(source);
      ir = ir + g[from] * er_[from] - b[from] * ei_[from];
      ii = ii + g[from] * ei_[from] + b[from] * er_[from];
    }
    const T* z = own_impedance(k, nonlinear_[i]);
    T zr = z[0], zi = z[1], er = er_[at], ei = ei_[at];
    if (const T* n = ratio(k, nonlinear_[i])) {
      const T share = T(1.0) / *n;
      er = er * share;
      ei = ei * share;
      zr = zr * *n;
      zi = zi * *n;
    }
    f[2 * i] = k.vr[i] - (er - zr * ir + zi * ii);
    f[2 * i + 1] = k.vi[i] - (ei - zr * ii - zi * ir);
  }
}

/// Computes the Jacobian of algebra_rest()'s residual with respect to V into `a`; call after it. dE/dV is a
/// difference quotient, whose error only slows the convergence.
template <class T>
void BatchKernel<T>::algebra_jacobian(const Constants& k, const T* x, T* a) {
  constexpr double nudge = 1e-6;  // step of the difference quotient [pu]
  const std::size_t count = nonlinear_.size(), size = 2 * count;
  T* derivative = algebra_.data() + size;  // dE/dV, four values per source
  for (std::size_t j = 0; j < count; ++j) {
    const int source = nonlinear_[j];
    const auto at = static_cast<std::size_t>(source);
    T er, ei;
    source_emf(k, x, source, k.vr[j] + T(nudge), k.vi[j], er, ei);
    derivative[4 * j] = (er - er_[at]) * T(1.0 / nudge);
    derivative[4 * j + 1] = (ei - ei_[at]) * T(1.0 / nudge);
    source_emf(k, x, source, k.vr[j], k.vi[j] + T(nudge), er, ei);
    derivative[4 * j + 2] = (er - er_[at]) * T(1.0 / nudge);
    derivative[4 * j + 3] = (ei - ei_[at]) * T(1.0 / nudge);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(nonlinear_[i]);
    const T* z = own_impedance(k, nonlinear_[i]);
    T zr = z[0], zi = z[1], share(1.0);
    if (const T* n = ratio(k, nonlinear_[i])) {
      share = T(1.0) / *n;
      zr = zr * *n;
      zi = zi * *n;
    }
    for (std::size_t j = 0; j < count; ++j) {
      const auto from = static_cast<std::size_t>(nonlinear_[j]);
      const T& g = k.g[at * static_cast<std::size_t>(sources_) + from];
      const T& b = k.b[at * static_cast<std::size_t>(sources_) + from];
      const double own = i == j ? 1.0 : 0.0;
      const T wr = (i == j ? share : T(0.0)) - (zr * g - zi * b), wi = T(0.0) - (zr * b + zi * g);  // dV/dE
      for (std::size_t side = 0; side < 2; ++side) {
        const T& dr = derivative[4 * j + 2 * side];
        const T& di = derivative[4 * j + 2 * side + 1];
        a[(2 * i) * size + 2 * j + side] = T(side == 0 ? own : 0.0) - (wr * dr - wi * di);
        a[(2 * i + 1) * size + 2 * j + side] = T(side == 1 ? own : 0.0) - (wr * di + wi * dr);
      }
    }
  }
}

/// Computes one Newton step into algebra_[0 .. 2K), with the stored factors of each lane, or with new ones in
/// the lanes of `anew`. Returns the largest component of the step.
template <class T>
T BatchKernel<T>::newton_step(Constants& k, const T* x, const T* steady, unsigned anew) {
  const std::size_t size = 2 * nonlinear_.size();
  T* f = algebra_.data();
  algebra_rest(k, x, steady);
  if (anew != 0) {
    constexpr unsigned all = (1U << kLanes) - 1U;
    T* a = anew == all ? k.factors.data() : f + 3 * size + size;
    algebra_jacobian(k, x, a);
    factor_dense(a, size);
    if (anew != all) {
      const auto mask = Traits::mask(anew);
      for (std::size_t i = 0; i < size * size; ++i) k.factors[i] = select(mask, a[i], k.factors[i]);
    }
    k.factored |= anew;
  }
  solve_factored(k.factors.data(), f, size);
  T largest(0.0);
  for (std::size_t i = 0; i < size; ++i) largest = maximum(absolute(f[i]), largest);
  return largest;
}

/// Convergence monitor of one lane's Newton iteration.
struct LaneSearch {
  double last = 0.0;  ///< size of the previous step [pu]; 0: none

  /// Returns true if the voltages have converged after a step of size `step` [pu]. `anew`: the step used
  /// factors that were computed at its starting point. Sets `slow` if the factors need renewal.
  bool found(double step, bool anew, bool& slow) {
    constexpr double near = 1e-7;     // [pu]; after such a short step with new factors, the error is 1e-13
    constexpr double left = 1e-13;    // tolerance of the voltages [pu]
    constexpr double slowest = 0.02;  // largest convergence rate accepted with old factors
    const bool known = last > 0.0;
    const double rate = known ? step / last : 1.0;
    last = step;
    slow = false;
    if (anew) return step < near;
    if (step * std::min(rate, 1.0) < left) return true;
    slow = known && !(rate < slowest) && step > near;
    return false;
  }
};

/// Runs Newton's method in the lanes of the bit mask `open`, starting from the voltages in k. Returns the
/// lanes that did not converge. Factors are reused in later searches as long as the iteration converges fast
/// enough: a factorisation costs O(K^3), a step O(K^2). The factors of a lane depend only on its own history.
template <class T>
unsigned BatchKernel<T>::search_voltages(Constants& k, const T* x, unsigned open) {
  constexpr int limit = 40, patience = 8;  // maximum steps; from step `patience` on, factors are renewed
  constexpr double longest = 0.3;  // largest step [pu]; a constant-power load may cause too large first steps
  constexpr unsigned all = (1U << kLanes) - 1U;
  const std::size_t count = nonlinear_.size();
  auto seeking = Traits::mask(open);
  std::array<LaneSearch, kLanes> search{};
  for (int step = 0; step < limit && open != 0; ++step) {
    const unsigned anew = open & (step >= patience ? all : ~k.factored);
    const T largest = newton_step(k, x, steady_.data(), anew);
    const T scale = T(longest) / maximum(T(longest), largest);
    for (std::size_t i = 0; i < count; ++i) {
      k.vr[i] = select(seeking, k.vr[i] - scale * algebra_[2 * i], k.vr[i]);
      k.vi[i] = select(seeking, k.vi[i] - scale * algebra_[2 * i + 1], k.vi[i]);
    }
    alignas(64) double size[kLanes];
    Traits::store(largest, size);
    for (int l = 0; l < kLanes; ++l) {
      const unsigned bit = 1U << l;
      if ((open & bit) == 0) continue;
      bool slow = false;
      if (search[static_cast<std::size_t>(l)].found(size[l], (anew & bit) != 0, slow)) open &= ~bit;
      if (slow) k.factored &= ~bit;
    }
    seeking = Traits::mask(open);
  }
  k.factored &= ~open;
  return open;
}

/// Sets the voltage from which Newton's method starts to `voltage` [pu], at every nonlinear source in the
/// lanes of the bit mask `lanes`, and invalidates the factors of these lanes.
template <class T>
void BatchKernel<T>::begin_search(Constants& k, unsigned lanes, double voltage) const {
  const auto these = Traits::mask(lanes);
  for (std::size_t i = 0; i < nonlinear_.size(); ++i) {
    k.vr[i] = select(these, T(voltage), k.vr[i]);
    k.vi[i] = select(these, T(0.0), k.vi[i]);
  }
  k.factored &= ~lanes;
}

/// Solves for the voltages at the nonlinear sources, starting from the previous solution. If this fails, it
/// restarts from zero voltage, because a prescribed current next to a fault may have no other solution
/// (decision 37).
template <class T>
void BatchKernel<T>::solve_algebra(Constants& k, const T* x) {
  constexpr unsigned all = (1U << kLanes) - 1U;
  const std::size_t count = nonlinear_.size();
  T* steady = steady_.data();
  for (const int source : nonlinear_)
    er_[static_cast<std::size_t>(source)] = ei_[static_cast<std::size_t>(source)] = T(0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = static_cast<std::size_t>(nonlinear_[i]) * static_cast<std::size_t>(sources_);
    row_times(&k.g[row], &k.b[row], er_.data(), ei_.data(), sources_, steady[2 * i], steady[2 * i + 1]);
  }
  unsigned open = search_voltages(k, x, all);
  if (open != 0) {
    k.fallen |= open;
    begin_search(k, open, 0.0);
    open = search_voltages(k, x, open);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(nonlinear_[i]);
    source_emf(k, x, nonlinear_[i], k.vr[i], k.vi[i], er_[at], ei_[at]);
    // Not converged: NaN causes the step's rejection.
    if (open != 0) er_[at] = select(Traits::mask(open), T(std::numeric_limits<double>::quiet_NaN()), er_[at]);
  }
  if (open != 0) begin_search(k, open, 1.0);
}

}  // namespace swingbank::sim::batch
