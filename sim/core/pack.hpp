#pragma once
// Pack<N>: N independent scenarios in one value, on the compiler's vector extension. Operators are one
// instruction per 8 lanes on AVX-512 and are lowered to what the target has elsewhere, so every width
// compiles on every machine.
#include <cmath>
#include <cstdint>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include "base/constants.hpp"

namespace swingbank::sim {

#ifdef SWINGBANK_COUNT_FLOPS
/// Additions, multiplications, divisions and roots of all packs, each lane one: for tests/bench.
inline thread_local std::uint64_t pack_operations = 0;
inline void count_operations(int lanes) { pack_operations += static_cast<std::uint64_t>(lanes); }
#else
inline void count_operations(int) {}
#endif

template <int N>
struct PackTypes;  // spelled out per width: GCC 12 drops vector_size on a dependent width
template <>
struct PackTypes<4> {
  typedef double Vector __attribute__((vector_size(32)));
  typedef std::int64_t Mask __attribute__((vector_size(32)));
};
template <>
struct PackTypes<8> {
  typedef double Vector __attribute__((vector_size(64)));
  typedef std::int64_t Mask __attribute__((vector_size(64)));
};

template <int N>
struct Pack {
  using Vector = typename PackTypes<N>::Vector;
  using Mask = typename PackTypes<N>::Mask;
  static constexpr int lanes = N;
  Vector v;
  Pack() = default;
  Pack(Vector a) : v(a) {}             // NOLINT(google-explicit-constructor): a pack is its vector
  Pack(double a) : v(a - Vector{}) {}  // NOLINT(google-explicit-constructor): broadcast
  double operator[](int lane) const { return v[lane]; }
  void set(int lane, double a) { v[lane] = a; }

  friend Pack operator+(Pack a, Pack b) { return counted(a.v + b.v); }
  friend Pack operator-(Pack a, Pack b) { return counted(a.v - b.v); }
  friend Pack operator*(Pack a, Pack b) { return counted(a.v * b.v); }
  friend Pack operator/(Pack a, Pack b) { return counted(a.v / b.v); }
  friend Pack operator-(Pack a) { return Pack(-a.v); }
  friend Mask operator<(Pack a, Pack b) { return a.v < b.v; }
  friend Mask operator>(Pack a, Pack b) { return a.v > b.v; }
  friend Mask operator<=(Pack a, Pack b) { return a.v <= b.v; }
  friend Pack select(Mask m, Pack a, Pack b) { return Pack(m ? a.v : b.v); }

 private:
  static Pack counted(Vector v) {
    count_operations(N);
    return Pack(v);
  }
};

template <int N>
inline Pack<N> sqrt(Pack<N> a) {
  count_operations(N);
#ifdef __AVX512F__
  if constexpr (N == 8) return Pack<N>((typename Pack<N>::Vector)_mm512_maskz_sqrt_pd(0xff, (__m512d)a.v));
#endif
  for (int i = 0; i < N; ++i) a.v[i] = std::sqrt(a.v[i]);
  return a;
}

/// Lane by lane through the C library: the same bits as for a double. For the few effects that need them.
template <int N>
inline Pack<N> exp(Pack<N> a) {
  for (int i = 0; i < N; ++i) a.v[i] = std::exp(a.v[i]);
  return a;
}
template <int N>
inline Pack<N> log(Pack<N> a) {
  for (int i = 0; i < N; ++i) a.v[i] = std::log(a.v[i]);
  return a;
}

/// Largest integer-valued rounding (to nearest even) by the 1.5·2^52 trick; |a| must stay below 2^51.
template <int N>
inline Pack<N> round_nearest(Pack<N> a) {
  const Pack<N> magic(6755399441055744.0);
  typename Pack<N>::Vector t = a.v + magic.v;
  return Pack<N>(t - magic.v);
}

/// Sine and cosine together, at most 2 ulp for |a| < 1e5 rad. Reduction by multiples of pi/2 in three
/// parts; minimax coefficients as in Moshier's Cephes library (sin.c).
template <int N>
inline void sincos(Pack<N> a, Pack<N>& s, Pack<N>& c) {
  using P = Pack<N>;
  using Mask = typename P::Mask;
  const P k = round_nearest(a * P(0.63661977236758134308));
  const P r = ((a - k * P(1.57079625129699707031)) - k * P(7.54978941586159635335e-8)) -
              k * P(5.39030252995776476555e-15);
  const P z = r * r;
  const P ps = ((((((P(1.58962301576546568060e-10) * z + P(-2.50507477628578072866e-8)) * z +
                    P(2.75573136213857245213e-6)) *
                       z +
                   P(-1.98412698295895385996e-4)) *
                      z +
                  P(8.33333333332211858878e-3)) *
                     z +
                 P(-1.66666666666666307295e-1)) *
                z) *
                   r +
               r;
  const P pc = ((((((P(-1.13585365213876817300e-11) * z + P(2.08757008419747316778e-9)) * z +
                    P(-2.75573141792967388112e-7)) *
                       z +
                   P(2.48015872888517045348e-5)) *
                      z +
                  P(-1.38888888888730564116e-3)) *
                     z +
                 P(4.16666666666665929218e-2)) *
                z) *
                   z +
               (P(1.0) - P(0.5) * z);
  const Mask q = __builtin_convertvector(k.v, Mask);
  const Mask odd = -(q & 1);
  const P ss = select(odd, pc, ps), cc = select(odd, ps, pc);
  const Mask ssign = (q & 2) << 62, csign = ((q + 1) & 2) << 62;
  s = P((typename P::Vector)((Mask)ss.v ^ ssign));
  c = P((typename P::Vector)((Mask)cc.v ^ csign));
}

/// Four-quadrant arctangent, at most 2 ulp; 0 where both arguments are 0. Reduction and rational
/// approximation as in Moshier's Cephes library (atan.c).
template <int N>
inline Pack<N> atan2(Pack<N> y, Pack<N> x) {
  using P = Pack<N>;
  using Mask = typename P::Mask;
  const Mask sign_bit = Mask{} + std::int64_t(1ULL << 63);
  const P a((typename P::Vector)((Mask)y.v & ~sign_bit)), b((typename P::Vector)((Mask)x.v & ~sign_bit));
  const Mask big = a > P(2.41421356237309504880) * b, mid = a > P(0.66) * b;
  const P numerator = select(big, -b, select(mid, a - b, a));
  P denominator = select(big, a, select(mid, a + b, b));
  denominator = select(denominator > P(0.0), denominator, P(1.0));
  const P offset = select(big, P(constants::pi / 2), select(mid, P(constants::pi / 4), P(0.0)));
  const P t = numerator / denominator, z = t * t;
  const P p = (((P(-8.750608600031904122785e-1) * z + P(-1.615753718733365076637e1)) * z +
                P(-7.500855792314704667340e1)) *
                   z +
               P(-1.228866684490136173410e2)) *
                  z +
              P(-6.485021904942025371773e1);
  const P q = ((((z + P(2.485846490142306297962e1)) * z + P(1.650270098316988542046e2)) * z +
                P(4.328810604912902668951e2)) *
                   z +
               P(4.853903996359136964868e2)) *
                  z +
              P(1.945506571482613964425e2);
  P r = offset + (t + t * (z * p / q));
  r = select(x < P(0.0), P(constants::pi) - r, r);
  return P((typename P::Vector)((Mask)r.v | ((Mask)y.v & sign_bit)));
}

}  // namespace swingbank::sim
