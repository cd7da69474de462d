#pragma once
// What the lanes kernel needs to know of a scalar: how many scenarios it carries, how to reach one, how to
// mask.
#include <cstdint>
#ifdef __AVX__
#include <immintrin.h>
#endif

#include "sim/core/scalar.hpp"

namespace swingbank::sim {

template <class T>
struct LaneTraits;

template <>
struct LaneTraits<double> {
  static constexpr int lanes = 1;
  static double get(double v, int) { return v; }
  static void set(double& v, int, double a) { v = a; }
  static bool mask(unsigned bits) { return (bits & 1U) != 0; }
  static double load(const double* v) { return *v; }
  static void store(double v, double* to) { *to = v; }
  static void stream(double v, double* to) { *to = v; }
};
template <int N>
struct LaneTraits<Pack<N>> {
  static constexpr int lanes = N;
  static double get(const Pack<N>& v, int l) { return v.v[l]; }
  static void set(Pack<N>& v, int l, double a) { reinterpret_cast<double*>(&v)[l] = a; }
  static typename Pack<N>::Mask mask(unsigned bits) {
    typename Pack<N>::Mask m;
    for (int l = 0; l < N; ++l) m[l] = -static_cast<std::int64_t>((bits >> l) & 1U);
    return m;
  }
  static Pack<N> load(const double* v) {
    Pack<N> p;
    __builtin_memcpy(&p, v, sizeof p);
    return p;
  }
  static void store(const Pack<N>& v, double* to) { __builtin_memcpy(to, &v, sizeof v); }
  /// Past the caches, to an address on a pack boundary: records are far larger than the caches and not read
  /// soon.
  static void stream(const Pack<N>& v, double* to) {
#ifdef __AVX512F__
    if constexpr (N == 8) return _mm512_stream_pd(to, (__m512d)v.v);
#endif
#ifdef __AVX__
    if constexpr (N == 4) return _mm256_stream_pd(to, (__m256d)v.v);
#endif
    store(v, to);
  }
};

inline double maximum(double a, double b) { return a > b ? a : b; }
inline double minimum(double a, double b) { return a < b ? a : b; }
inline double absolute(double a) { return std::fabs(a); }
template <int N>
inline Pack<N> maximum(Pack<N> a, Pack<N> b) {
  return Pack<N>(a.v > b.v ? a.v : b.v);
}
template <int N>
inline Pack<N> minimum(Pack<N> a, Pack<N> b) {
  return Pack<N>(a.v < b.v ? a.v : b.v);
}
template <int N>
inline Pack<N> absolute(Pack<N> a) {
  return maximum(a, -a);
}
inline double round_nearest(double a) { return std::nearbyint(a); }

}  // namespace swingbank::sim
