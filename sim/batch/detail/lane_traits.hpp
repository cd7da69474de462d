#pragma once
// Traits of a scalar type for the batch kernel: number of lanes, access to one lane, masks.
#include <cstdint>
#ifdef __AVX__
#include <immintrin.h>
#endif

#include "sim/core/float_pack.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim::batch {

template <class T>
struct LaneTraits;

template <>
struct LaneTraits<double> {
  using Real = double;  ///< type of one lane
  static constexpr int lanes = 1;
  static double get(double v, int) { return v; }
  static void set(double& v, int, double a) { v = a; }
  static bool mask(unsigned bits) { return (bits & 1U) != 0; }
  static double load(const double* v) { return *v; }
  static void store(double v, double* to) { *to = v; }
  static void stream(double v, double* to) { *to = v; }
};
#ifdef __AVX__
/// Writes doubles register by register with non-temporal stores.
template <class S, int N>
inline void stream_registers(const Packed<S, N>& v, double* to) {
  if constexpr (!Packed<S, N>::one_register) {
    stream_registers(v.low, to);
    stream_registers(v.high, to + N / 2);
#ifdef __AVX512F__
  } else if constexpr (sizeof v == 64 && sizeof(S) == 8) {
    _mm512_stream_pd(to, (__m512d)v.v);
  } else if constexpr (sizeof v == 64) {
    const auto halves = (__m512d)v.v;
    _mm512_stream_pd(to, _mm512_cvtps_pd((__m256)_mm512_castpd512_pd256(halves)));
    _mm512_stream_pd(to + 8, _mm512_cvtps_pd((__m256)_mm512_extractf64x4_pd(halves, 1)));
#endif
  } else if constexpr (sizeof(S) == 8) {
    _mm256_stream_pd(to, (__m256d)v.v);
  } else {
    const auto floats = (__m256)v.v;
    _mm256_stream_pd(to, _mm256_cvtps_pd(_mm256_castps256_ps128(floats)));
    _mm256_stream_pd(to + 4, _mm256_cvtps_pd(_mm256_extractf128_ps(floats, 1)));
  }
}
#endif

template <class S, int N>
struct LaneTraits<Packed<S, N>> {
  using Flat = Packed<S, N>;
  using Real = S;
  static constexpr int lanes = N;
  static double get(const Flat& v, int l) { return v[l]; }
  static void set(Flat& v, int l, double a) { reinterpret_cast<S*>(&v)[l] = static_cast<S>(a); }
  static typename Flat::Mask mask(unsigned bits) { return Flat::mask(bits); }
  static Flat load(const S* v) { return Flat::load(v); }
  static void store(const Flat& v, S* to) { v.store(to); }
  // Times, errors and records have double precision.
  static Flat load(const double* v) requires(sizeof(S) < sizeof(double)) {
    Flat p;
    for (int l = 0; l < lanes; ++l) set(p, l, v[l]);
    return p;
  }
  static void store(const Flat& v, double* to) requires(sizeof(S) < sizeof(double)) {
    const S* from = reinterpret_cast<const S*>(&v);
    for (int l = 0; l < lanes; ++l) to[l] = from[l];
  }
  /// Bypasses the caches if a pack fills whole cache lines, because records are far larger than the caches
  /// and not read soon. A partial line would be written to memory twice.
  static void stream(const Flat& v, double* to) {
#ifdef __AVX__
    if constexpr (N * sizeof(double) % 64 == 0)
      stream_registers(v, to);
    else
#endif
      store(v, to);
  }
};

inline double maximum(double a, double b) { return a > b ? a : b; }
inline double minimum(double a, double b) { return a < b ? a : b; }
inline double absolute(double a) { return std::fabs(a); }
template <class S, int N>
inline Packed<S, N> maximum(Packed<S, N> a, Packed<S, N> b) {
  return select(a > b, a, b);
}
template <class S, int N>
inline Packed<S, N> minimum(Packed<S, N> a, Packed<S, N> b) {
  return select(a < b, a, b);
}
/// Returns the larger of two values, or NaN if one of them is NaN.
template <class T>
inline T maximum_or_nan(const T& a, const T& b) {
  return select(b <= a, a, b + a * T(0.0));  // a NaN in a fails the comparison, and remains by the product
}
inline double round_nearest(double a) { return std::nearbyint(a); }

}  // namespace swingbank::sim::batch
