#pragma once
// Checks of the BLAS library: correctness of its products, and speed relative to the processor's peak.
#include <string>

namespace swingbank::train::runtime {
struct BlasFound;

/// Single-precision rates on one core [GFLOP/s]: the best of several runs, relative to this thread's
/// processor time.
struct BlasRate {
  double product = 0.0;        ///< product of 512 x 512 matrices by the library; 0: no library
  double multiply_adds = 0.0;  ///< multiply-adds with the widest instructions: upper bound
  [[nodiscard]] double share() const { return product / multiply_adds; }
  [[nodiscard]] std::string sentence() const;
  /// Returns a warning if the library reaches less than 40 % of the multiply-add rate, else an empty string.
  [[nodiscard]] std::string warning() const;
};
/// Returns the rates. They are measured once per process, by a single thread, so that the process may fork
/// later.
const BlasRate& blas_rate();

/// Compares products of odd sizes, also of transposed matrices, with a plain loop in double precision. Throws
/// InputError if one is wrong.
void require_right_products(const BlasFound& found);

}  // namespace swingbank::train::runtime
