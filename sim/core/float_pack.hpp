#pragma once
// FloatPack: sixteen independent scenarios in single precision, with the operators and functions of Pack
// (pack.hpp). Twice the lanes of a pack of doubles of the same size; who sums up in it carries what a float
// does not hold along.
#include <cmath>
#include <cstdint>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include "base/constants.hpp"

namespace swingbank::sim {

struct FloatPack {
  typedef float Vector __attribute__((vector_size(64)));
  typedef std::int32_t Mask __attribute__((vector_size(64)));
  static constexpr int lanes = 16;
  Vector v;
  FloatPack() = default;
  FloatPack(Vector a) : v(a) {}                                 // NOLINT(google-explicit-constructor)
  FloatPack(double a) : v(static_cast<float>(a) - Vector{}) {}  // NOLINT(google-explicit-constructor)
  float operator[](int lane) const { return v[lane]; }
  void set(int lane, double a) { v[lane] = static_cast<float>(a); }

  friend FloatPack operator+(FloatPack a, FloatPack b) { return a.v + b.v; }
  friend FloatPack operator-(FloatPack a, FloatPack b) { return a.v - b.v; }
  friend FloatPack operator*(FloatPack a, FloatPack b) { return a.v * b.v; }
  friend FloatPack operator/(FloatPack a, FloatPack b) { return a.v / b.v; }
  friend FloatPack operator-(FloatPack a) { return -a.v; }
  friend Mask operator<(FloatPack a, FloatPack b) { return a.v < b.v; }
  friend Mask operator>(FloatPack a, FloatPack b) { return a.v > b.v; }
  friend Mask operator<=(FloatPack a, FloatPack b) { return a.v <= b.v; }
  friend FloatPack select(Mask m, FloatPack a, FloatPack b) { return m ? a.v : b.v; }
};

inline FloatPack sqrt(FloatPack a) {
#ifdef __AVX512F__
  return FloatPack::Vector(_mm512_maskz_sqrt_ps(0xffff, (__m512)a.v));
#else
  for (int i = 0; i < FloatPack::lanes; ++i) a.v[i] = std::sqrt(a.v[i]);
  return a;
#endif
}
inline FloatPack exp(FloatPack a) {
  for (int i = 0; i < FloatPack::lanes; ++i) a.v[i] = std::exp(a.v[i]);
  return a;
}
inline FloatPack log(FloatPack a) {
  for (int i = 0; i < FloatPack::lanes; ++i) a.v[i] = std::log(a.v[i]);
  return a;
}

/// To the nearest whole number (to even) by the 1.5·2^23 trick; |a| must stay below 2^22.
inline FloatPack round_nearest(FloatPack a) {
  const FloatPack magic(12582912.0);
  const FloatPack::Vector t = a.v + magic.v;
  return t - magic.v;
}

/// Sine and cosine together, for |a| < 1e4 rad. Reduction by multiples of pi/2 in three parts; minimax
/// coefficients as in Moshier's Cephes library (sinf.c).
inline void sincos(FloatPack a, FloatPack& s, FloatPack& c) {
  using P = FloatPack;
  using Mask = P::Mask;
  const P k = round_nearest(a * P(0.63661977236758134308));
  const P r = ((a - k * P(1.5703125)) - k * P(4.837512969970703125e-4)) - k * P(7.549789948768648e-8);
  const P z = r * r;
  const P ps = ((P(-1.9515295891e-4) * z + P(8.3321608736e-3)) * z + P(-1.6666654611e-1)) * z * r + r;
  const P pc =
      ((P(2.443315711809948e-5) * z + P(-1.388731625493765e-3)) * z + P(4.166664568298827e-2)) * z * z +
      (P(1.0) - P(0.5) * z);
  const Mask q = __builtin_convertvector(k.v, Mask);
  const Mask odd = -(q & 1);
  const P ss = select(odd, pc, ps), cc = select(odd, ps, pc);
  const Mask ssign = (q & 2) << 30, csign = ((q + 1) & 2) << 30;
  s = P::Vector((Mask)ss.v ^ ssign);
  c = P::Vector((Mask)cc.v ^ csign);
}

/// Four-quadrant arctangent; 0 where both arguments are 0. Reduction and polynomial as in Moshier's Cephes
/// library (atanf.c).
inline FloatPack atan2(FloatPack y, FloatPack x) {
  using P = FloatPack;
  using Mask = P::Mask;
  const Mask sign_bit = Mask{} + std::int32_t(1U << 31);
  const P a(P::Vector((Mask)y.v & ~sign_bit)), b(P::Vector((Mask)x.v & ~sign_bit));
  const Mask big = a > P(2.41421356237309504880) * b, mid = a > P(0.41421356237309504880) * b;
  const P numerator = select(big, -b, select(mid, a - b, a));
  P denominator = select(big, a, select(mid, a + b, b));
  denominator = select(denominator > P(0.0), denominator, P(1.0));
  const P offset = select(big, P(constants::pi / 2), select(mid, P(constants::pi / 4), P(0.0)));
  const P t = numerator / denominator, z = t * t;
  const P p =
      ((P(8.05374449538e-2) * z + P(-1.38776856032e-1)) * z + P(1.99777106478e-1)) * z + P(-3.33329491539e-1);
  P r = offset + (p * z * t + t);
  r = select(x < P(0.0), P(constants::pi) - r, r);
  return P::Vector((Mask)r.v | ((Mask)y.v & sign_bit));
}

/// Lane 0: for messages and branches in double code only.
inline double value_of(const FloatPack& a) { return a[0]; }
inline bool any_positive(const FloatPack& a) {
#ifdef __AVX512F__
  return _mm512_cmp_ps_mask((__m512)a.v, _mm512_setzero_ps(), _CMP_GT_OQ) != 0;
#else
  bool any = false;
  for (int lane = 0; lane < FloatPack::lanes; ++lane) any |= a[lane] > 0.0F;
  return any;
#endif
}

}  // namespace swingbank::sim
