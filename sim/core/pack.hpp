#pragma once
// Packed<S, N>: N independent scenarios in one value (a SIMD batch). Up to a register's size it is one vector
// of the compiler's vector extension; a wider value consists of two halves. GCC would pass a vector wider
// than a register through memory. Halves avoid this on every processor.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#ifdef __AVX__
#include <immintrin.h>
#endif

#include "base/constants.hpp"

namespace swingbank::sim {

#ifdef SWINGBANK_COUNT_FLOPS
/// Number of additions, multiplications, divisions and roots of all packs; each lane counts separately. Used
/// by tests/bench.
inline thread_local std::uint64_t pack_operations = 0;
inline void count_operations(int lanes) { pack_operations += static_cast<std::uint64_t>(lanes); }
#else
/// Counts one operation in each of `lanes` lanes; does nothing in builds without SWINGBANK_COUNT_FLOPS.
inline void count_operations(int) {}
#endif

/// Size of the target's vector register [bytes].
#if defined(__AVX512F__)
inline constexpr std::size_t kRegisterBytes = 64;
#elif defined(__AVX__)
inline constexpr std::size_t kRegisterBytes = 32;
#else
inline constexpr std::size_t kRegisterBytes = 16;
#endif

/// \cond
template <class S, std::size_t Bytes>
struct VectorOf;  // one specialisation per width, because GCC 12 ignores vector_size with a dependent width
template <class S>
struct VectorOf<S, 16> {
  typedef S Type __attribute__((vector_size(16)));
  typedef S InMemory __attribute__((vector_size(16), aligned(sizeof(S)), may_alias));
};
template <class S>
struct VectorOf<S, 32> {
  typedef S Type __attribute__((vector_size(32)));
  typedef S InMemory __attribute__((vector_size(32), aligned(sizeof(S)), may_alias));
};
template <class S>
struct VectorOf<S, 64> {
  typedef S Type __attribute__((vector_size(64)));
  typedef S InMemory __attribute__((vector_size(64), aligned(sizeof(S)), may_alias));
};
/// \endcond

/// N numbers of type S (double or float), wider than a register and therefore stored as two halves.
template <class S, int N>
struct Packed {
  using Half = Packed<S, N / 2>;  ///< one half of the lanes
  /// Result of a comparison, one truth value for each lane.
  struct Mask {
    typename Half::Mask low, high;  ///< masks of the two halves
  };
  static constexpr int lanes = N;              ///< number of lanes N
  static constexpr bool one_register = false;  ///< whether the value is one vector register
  Half low, high;                              ///< lanes 0 ... N/2-1 and N/2 ... N-1
  Packed() = default;
  /// Broadcasts a number to all lanes.
  Packed(double a) : low(a), high(a) {}  // NOLINT(google-explicit-constructor): broadcast
  /// Joins two halves.
  Packed(Half l, Half h) : low(l), high(h) {}
  /// Value of one lane.
  S operator[](int lane) const { return lane < N / 2 ? low[lane] : high[lane - N / 2]; }
  /// Sets one lane.
  void set(int lane, double a) { lane < N / 2 ? low.set(lane, a) : high.set(lane - N / 2, a); }
  /// Loads N numbers; `from` needs no alignment.
  static Packed load(const S* from) { return {Half::load(from), Half::load(from + N / 2)}; }
  /// Stores N numbers; `to` needs no alignment.
  void store(S* to) const {
    low.store(to);
    high.store(to + N / 2);
  }
  /// Returns the mask in which lane l is set where bit l of `bits` is.
  static Mask mask(unsigned bits) { return {Half::mask(bits), Half::mask(bits >> (N / 2))}; }

  /// Returns the lane-wise sum.
  friend Packed operator+(Packed a, Packed b) { return {a.low + b.low, a.high + b.high}; }
  /// Returns the lane-wise difference.
  friend Packed operator-(Packed a, Packed b) { return {a.low - b.low, a.high - b.high}; }
  /// Returns the lane-wise product.
  friend Packed operator*(Packed a, Packed b) { return {a.low * b.low, a.high * b.high}; }
  /// Returns the lane-wise quotient.
  friend Packed operator/(Packed a, Packed b) { return {a.low / b.low, a.high / b.high}; }
  /// Returns the lane-wise negation.
  friend Packed operator-(Packed a) { return {-a.low, -a.high}; }
  /// Compares lane by lane.
  friend Mask operator<(Packed a, Packed b) { return {a.low < b.low, a.high < b.high}; }
  /// Compares lane by lane.
  friend Mask operator>(Packed a, Packed b) { return {a.low > b.low, a.high > b.high}; }
  /// Compares lane by lane.
  friend Mask operator<=(Packed a, Packed b) { return {a.low <= b.low, a.high <= b.high}; }
  /// Returns a in the lanes set in m, b in the others.
  friend Packed select(Mask m, Packed a, Packed b) {
    return {select(m.low, a.low, b.low), select(m.high, a.high, b.high)};
  }
  /// Whether any lane is above zero.
  friend bool any_positive(Packed a) { return any_positive(a.low) || any_positive(a.high); }
};

/// N numbers that fit into one vector register.
template <class S, int N>
requires(sizeof(S) * N <= kRegisterBytes) struct Packed<S, N> {
  using Vector = typename VectorOf<S, sizeof(S) * N>::Type;  ///< vector of N numbers in a register
  /// The vector in memory, aligned to one number.
  using InMemory = typename VectorOf<S, sizeof(S) * N>::InMemory;
  /// Signed integer of the size of S.
  using Integer = std::conditional_t<sizeof(S) == 8, std::int64_t, std::int32_t>;
  using Mask = typename VectorOf<Integer, sizeof(S) * N>::Type;  ///< result of a comparison: a lane with the
                                                                 ///< result true has all bits set
  static constexpr int lanes = N;                                ///< number of lanes N
  static constexpr bool one_register = true;                     ///< whether the value is one vector register
  Vector v;                                                      ///< all lanes
  Packed() = default;
  /// Wraps a vector.
  Packed(Vector a) : v(a) {}  // NOLINT(google-explicit-constructor)
  /// Broadcasts a number to all lanes.
  Packed(double a) : v(static_cast<S>(a) - Vector{}) {}  // NOLINT(google-explicit-constructor): broadcast
  S operator[](int lane) const { return v[lane]; }       ///< value of one lane
  /// Sets one lane.
  void set(int lane, double a) { v[lane] = static_cast<S>(a); }
  /// Loads N numbers; `from` needs no alignment. The vector type is loaded directly, because GCC would copy
  /// bytes through integer registers.
  static Packed load(const S* from) { return Vector(*reinterpret_cast<const InMemory*>(from)); }
  /// Stores N numbers; `to` needs no alignment.
  void store(S* to) const { *reinterpret_cast<InMemory*>(to) = v; }
  /// Returns the mask in which lane l is set where bit l of `bits` is.
  static Mask mask(unsigned bits) {
    Mask lane_bit{};
    for (int l = 0; l < N; ++l) lane_bit[l] = Integer(1) << l;
    return (lane_bit & static_cast<Integer>(bits)) != 0;
  }

  /// Returns the lane-wise sum.
  friend Packed operator+(Packed a, Packed b) { return counted(a.v + b.v); }
  /// Returns the lane-wise difference.
  friend Packed operator-(Packed a, Packed b) { return counted(a.v - b.v); }
  /// Returns the lane-wise product.
  friend Packed operator*(Packed a, Packed b) { return counted(a.v * b.v); }
  /// Returns the lane-wise quotient.
  friend Packed operator/(Packed a, Packed b) { return counted(a.v / b.v); }
  /// Returns the lane-wise negation.
  friend Packed operator-(Packed a) { return Packed(-a.v); }
  /// Compares lane by lane.
  friend Mask operator<(Packed a, Packed b) { return a.v < b.v; }
  /// Compares lane by lane.
  friend Mask operator>(Packed a, Packed b) { return a.v > b.v; }
  /// Compares lane by lane.
  friend Mask operator<=(Packed a, Packed b) { return a.v <= b.v; }
  /// Returns a in the lanes set in m, b in the others.
  friend Packed select(Mask m, Packed a, Packed b) { return Packed(m ? a.v : b.v); }
  /// Whether any lane is above zero.
  friend bool any_positive(Packed a) {
#ifdef __AVX512F__
    if constexpr (sizeof a == 64 && sizeof(S) == 8)
      return _mm512_cmp_pd_mask((__m512d)a.v, _mm512_setzero_pd(), _CMP_GT_OQ) != 0;
    else if constexpr (sizeof a == 64)
      return _mm512_cmp_ps_mask((__m512)a.v, _mm512_setzero_ps(), _CMP_GT_OQ) != 0;
#endif
#ifdef __AVX__
    if constexpr (sizeof a == 32 && sizeof(S) == 8)
      return _mm256_movemask_pd(_mm256_cmp_pd((__m256d)a.v, _mm256_setzero_pd(), _CMP_GT_OQ)) != 0;
    else if constexpr (sizeof a == 32)
      return _mm256_movemask_ps(_mm256_cmp_ps((__m256)a.v, _mm256_setzero_ps(), _CMP_GT_OQ)) != 0;
#endif
    bool any = false;
    for (int lane = 0; lane < N; ++lane) any |= a[lane] > 0;
    return any;
  }

 private:
  static Packed counted(Vector v) {
    count_operations(N);
    return Packed(v);
  }
};
/// N doubles.
template <int N>
using Pack = Packed<double, N>;

/// Returns the square root, lane by lane.
template <class S, int N>
inline Packed<S, N> sqrt(Packed<S, N> a) {
  if constexpr (!Packed<S, N>::one_register) {
    return {sqrt(a.low), sqrt(a.high)};
  } else {
    count_operations(N);
    using Vector [[maybe_unused]] = typename Packed<S, N>::Vector;
#ifdef __AVX512F__
    if constexpr (sizeof a == 64 && sizeof(S) == 8)
      return Vector(_mm512_maskz_sqrt_pd(0xff, (__m512d)a.v));
    else if constexpr (sizeof a == 64)
      return Vector(_mm512_maskz_sqrt_ps(0xffff, (__m512)a.v));
#endif
#ifdef __AVX__
    if constexpr (sizeof a == 32 && sizeof(S) == 8)
      return Vector(_mm256_sqrt_pd((__m256d)a.v));
    else if constexpr (sizeof a == 32)
      return Vector(_mm256_sqrt_ps((__m256)a.v));
#endif
    for (int i = 0; i < N; ++i) a.v[i] = std::sqrt(a.v[i]);
    return a;
  }
}

/// Returns the exponential. The C library computes it lane by lane, so that it is bitwise equal to the scalar
/// result. Only few effects need it.
template <class S, int N>
inline Packed<S, N> exp(Packed<S, N> a) {
  for (int i = 0; i < N; ++i) a.set(i, std::exp(a[i]));
  return a;
}
/// Returns the natural logarithm, computed like exp().
template <class S, int N>
inline Packed<S, N> log(Packed<S, N> a) {
  for (int i = 0; i < N; ++i) a.set(i, std::log(a[i]));
  return a;
}

/// Rounds to the nearest integer (ties to even). Adding 1.5 * 2^52 (double) or 1.5 * 2^23 (float) rounds the
/// fraction away. |a| must stay below 2^51 (double) or 2^22 (float).
template <class S, int N>
inline Packed<S, N> round_nearest(Packed<S, N> a) {
  if constexpr (!Packed<S, N>::one_register) {
    return {round_nearest(a.low), round_nearest(a.high)};
  } else {
    const Packed<S, N> magic(sizeof(S) == 8 ? 6755399441055744.0 : 12582912.0);
    const typename Packed<S, N>::Vector t = a.v + magic.v;
    return Packed<S, N>(t - magic.v);
  }
}

/// Computes sine `s` and cosine `c` of an angle from `sine` and `cosine` of its remainder after k quarter
/// turns.
template <class S, int N>
inline void turn(Packed<S, N> k, Packed<S, N> sine, Packed<S, N> cosine, Packed<S, N>& s, Packed<S, N>& c) {
  if constexpr (!Packed<S, N>::one_register) {
    turn(k.low, sine.low, cosine.low, s.low, c.low);
    turn(k.high, sine.high, cosine.high, s.high, c.high);
  } else {
    using P = Packed<S, N>;
    using Mask = typename P::Mask;
    constexpr int kToSign = 8 * sizeof(S) - 2;
    const Mask q = __builtin_convertvector(k.v, Mask);
    const Mask odd = -(q & 1);
    const P ss = select(odd, cosine, sine), cc = select(odd, sine, cosine);
    const Mask ssign = (q & 2) << kToSign, csign = ((q + 1) & 2) << kToSign;
    s = P((typename P::Vector)((Mask)ss.v ^ ssign));
    c = P((typename P::Vector)((Mask)cc.v ^ csign));
  }
}
/// Returns |a|.
template <class S, int N>
inline Packed<S, N> absolute(Packed<S, N> a) {
  if constexpr (!Packed<S, N>::one_register) {
    return {absolute(a.low), absolute(a.high)};
  } else {
    using Mask = typename Packed<S, N>::Mask;
    const Mask sign = (Mask)(Packed<S, N>(-0.0).v);
    return Packed<S, N>((typename Packed<S, N>::Vector)((Mask)a.v & ~sign));
  }
}
/// Returns |a| with the sign of b.
template <class S, int N>
inline Packed<S, N> with_sign(Packed<S, N> a, Packed<S, N> b) {
  if constexpr (!Packed<S, N>::one_register) {
    return {with_sign(a.low, b.low), with_sign(a.high, b.high)};
  } else {
    using Mask = typename Packed<S, N>::Mask;
    const Mask sign = (Mask)(Packed<S, N>(-0.0).v);
    return Packed<S, N>((typename Packed<S, N>::Vector)(((Mask)a.v & ~sign) | ((Mask)b.v & sign)));
  }
}

/// Computes sine and cosine together, with an error of at most 2 ulp for |a| < 1e5 rad. The argument is
/// reduced by multiples of pi/2 in three parts. The minimax coefficients are from Moshier's Cephes library
/// (sin.c).
template <int N>
inline void sincos(Pack<N> a, Pack<N>& s, Pack<N>& c) {
  using P = Pack<N>;
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
  turn(k, ps, pc, s, c);
}

/// Returns the four-quadrant arctangent [rad] with an error of at most 2 ulp, or 0 if both arguments are 0.
/// Reduction and rational approximation are from Moshier's Cephes library (atan.c).
template <int N>
inline Pack<N> atan2(Pack<N> y, Pack<N> x) {
  using P = Pack<N>;
  const P a = absolute(y), b = absolute(x);
  const typename P::Mask big = a > P(2.41421356237309504880) * b, mid = a > P(0.66) * b;
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
  return with_sign(r, y);
}

}  // namespace swingbank::sim
