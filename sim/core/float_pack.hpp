#pragma once
// FloatPack: sixteen independent scenarios in single precision. It has twice the lanes of a Pack of the same
// size. Sums over many steps need compensated summation, because a float has only seven digits.
#include "sim/core/pack.hpp"

namespace swingbank::sim {

/// Sixteen single-precision numbers.
using FloatPack = Packed<float, 16>;

/// Computes sine and cosine together, for |a| < 1e4 rad. The argument is reduced by multiples of pi/2 in
/// three parts. The minimax coefficients are from Moshier's Cephes library (sinf.c).
inline void sincos(FloatPack a, FloatPack& s, FloatPack& c) {
  using P = FloatPack;
  const P k = round_nearest(a * P(0.63661977236758134308));
  const P r = ((a - k * P(1.5703125)) - k * P(4.837512969970703125e-4)) - k * P(7.549789948768648e-8);
  const P z = r * r;
  const P ps = ((P(-1.9515295891e-4) * z + P(8.3321608736e-3)) * z + P(-1.6666654611e-1)) * z * r + r;
  const P pc =
      ((P(2.443315711809948e-5) * z + P(-1.388731625493765e-3)) * z + P(4.166664568298827e-2)) * z * z +
      (P(1.0) - P(0.5) * z);
  turn(k, ps, pc, s, c);
}

/// Returns the four-quadrant arctangent [rad], or 0 if both arguments are 0. Reduction and polynomial are
/// from Moshier's Cephes library (atanf.c).
inline FloatPack atan2(FloatPack y, FloatPack x) {
  using P = FloatPack;
  const P a = absolute(y), b = absolute(x);
  const P::Mask big = a > P(2.41421356237309504880) * b, mid = a > P(0.41421356237309504880) * b;
  const P numerator = select(big, -b, select(mid, a - b, a));
  P denominator = select(big, a, select(mid, a + b, b));
  denominator = select(denominator > P(0.0), denominator, P(1.0));
  const P offset = select(big, P(constants::pi / 2), select(mid, P(constants::pi / 4), P(0.0)));
  const P t = numerator / denominator, z = t * t;
  const P p =
      ((P(8.05374449538e-2) * z + P(-1.38776856032e-1)) * z + P(1.99777106478e-1)) * z + P(-3.33329491539e-1);
  P r = offset + (p * z * t + t);
  r = select(x < P(0.0), P(constants::pi) - r, r);
  return with_sign(r, y);
}

}  // namespace swingbank::sim
