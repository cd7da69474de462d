#pragma once
// What the lanes kernel needs to know of a scalar: how many scenarios it carries, how to reach one, how to
// mask.
#include <cstdint>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include "sim/core/float_pack.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim::lanes {

template <class T>
struct LaneTraits;

template <>
struct LaneTraits<double> {
  using Flat = double;
  using Real = double;  ///< of one lane
  static constexpr int lanes = 1, directions = 0;
  static double get(double v, int) { return v; }
  static void set(double& v, int, double a) { v = a; }
  static bool mask(unsigned bits) { return (bits & 1U) != 0; }
  static double load(const double* v) { return *v; }
  static void store(double v, double* to) { *to = v; }
  static void stream(double v, double* to) { *to = v; }
  static double value(double v) { return v; }
  static double constant(double v) { return v; }
  static double magnitude(double v) { return std::fabs(v); }
};
template <int N>
struct LaneTraits<Pack<N>> {
  using Flat = Pack<N>;
  using Real = double;
  static constexpr int lanes = N, directions = 0;
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
  /// Past the caches where a pack is a whole line of them: records are far larger than the caches and not
  /// read soon. Half a line would go to memory by itself, before its other half comes after all other rows.
  static void stream(const Pack<N>& v, double* to) {
#ifdef __AVX512F__
    if constexpr (N == 8) return _mm512_stream_pd(to, (__m512d)v.v);
#endif
    store(v, to);
  }
  static Pack<N> value(const Pack<N>& v) { return v; }
  static Pack<N> constant(const Pack<N>& v) { return v; }
  static Pack<N> magnitude(const Pack<N>& v) { return Pack<N>(v.v > -v.v ? v.v : -v.v); }
};
template <>
struct LaneTraits<FloatPack> {
  using Flat = FloatPack;
  using Real = float;
  static constexpr int lanes = FloatPack::lanes, directions = 0;
  static double get(const FloatPack& v, int l) { return v.v[l]; }
  static void set(FloatPack& v, int l, double a) { reinterpret_cast<float*>(&v)[l] = static_cast<float>(a); }
  static FloatPack::Mask mask(unsigned bits) {
#ifdef __AVX512F__
    return FloatPack::Mask(_mm512_maskz_set1_epi32(static_cast<__mmask16>(bits), -1));
#else
    FloatPack::Mask m;
    for (int l = 0; l < lanes; ++l) m[l] = -static_cast<std::int32_t>((bits >> l) & 1U);
    return m;
#endif
  }
  static FloatPack load(const float* v) {
    FloatPack p;
    __builtin_memcpy(&p, v, sizeof p);
    return p;
  }
  static void store(const FloatPack& v, float* to) { __builtin_memcpy(to, &v, sizeof v); }
  // Times, errors and records are double.
  static FloatPack load(const double* v) {
    FloatPack p;
    for (int l = 0; l < lanes; ++l) p.v[l] = static_cast<float>(v[l]);
    return p;
  }
  static void store(const FloatPack& v, double* to) {
    for (int l = 0; l < lanes; ++l) to[l] = v.v[l];
  }
  static void stream(const FloatPack& v, double* to) {
#ifdef __AVX512F__
    const auto halves = (__m512d)v.v;
    _mm512_stream_pd(to, _mm512_cvtps_pd((__m256)_mm512_castpd512_pd256(halves)));
    _mm512_stream_pd(to + 8, _mm512_cvtps_pd((__m256)_mm512_extractf64x4_pd(halves, 1)));
#else
    store(v, to);
#endif
  }
  static FloatPack value(const FloatPack& v) { return v; }
  static FloatPack constant(const FloatPack& v) { return v; }
  static FloatPack magnitude(const FloatPack& v) { return v.v > -v.v ? v.v : -v.v; }
};
/// Sensitivities ride in the lanes: a value is 1 + D flats, one after the other.
template <int N, int D>
struct LaneTraits<Dual<Pack<N>, D>> {
  using T = Dual<Pack<N>, D>;
  using Flat = Pack<N>;
  using Of = LaneTraits<Flat>;
  using Real = double;
  static constexpr int lanes = N, directions = D;
  static_assert(sizeof(T) == (1 + D) * sizeof(Flat));
  static double get(const T& v, int l) { return v.a.v[l]; }
  static void set(T& v, int l, double a) {
    Of::set(v.a, l, a);
    for (auto& d : v.d) Of::set(d, l, 0.0);
  }
  static void set_slope(T& v, int l, int direction, double a) {
    Of::set(v.d[static_cast<std::size_t>(direction)], l, a);
  }
  static typename Flat::Mask mask(unsigned bits) { return Of::mask(bits); }
  static Flat value(const T& v) { return v.a; }
  static T constant(const Flat& v) {
    T r(0.0);
    r.a = v;
    return r;
  }
  /// A slope's error counts like a value's: slopes are per unit of the parameter's own scale.
  static Flat magnitude(const T& v) {
    Flat m = Of::magnitude(v.a);
    for (const auto& d : v.d) {
      const Flat e = Of::magnitude(d);
      m = select(e <= m, m, e);  // in this order a NaN wins
    }
    return m;
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
inline FloatPack maximum(FloatPack a, FloatPack b) { return a.v > b.v ? a.v : b.v; }
inline FloatPack minimum(FloatPack a, FloatPack b) { return a.v < b.v ? a.v : b.v; }
inline FloatPack absolute(FloatPack a) { return maximum(a, -a); }
inline double round_nearest(double a) { return std::nearbyint(a); }
template <class T, int D>
Dual<T, D> maximum(const Dual<T, D>& a, const Dual<T, D>& b) {
  return select(a > b, a, b);
}
template <class T, int D>
Dual<T, D> minimum(const Dual<T, D>& a, const Dual<T, D>& b) {
  return select(a < b, a, b);
}
template <class T, int D>
Dual<T, D> absolute(const Dual<T, D>& a) {
  return maximum(a, -a);
}
template <class T, int D>
Dual<T, D> round_nearest(const Dual<T, D>& a) {
  return chain(a, round_nearest(a.a), T(0.0));
}

}  // namespace swingbank::sim::lanes
