#pragma once
// Whether the BLAS library multiplies rightly, and how fast beside what the processor itself can do.
#include <string>

namespace swingbank::train::runtime {
struct BlasFound;

/// Single precision on one core, best of several goes, by the processor time of this thread. [GFLOP/s]
struct BlasRate {
  double product = 0.0;  ///< 512 x 512 times 512 x 512 by the library; 0 if there is none
  double multiply_adds =
      0.0;  ///< independent multiply-adds at the widest instructions: what no product exceeds
  [[nodiscard]] double share() const { return product / multiply_adds; }
  [[nodiscard]] std::string sentence() const;
  /// A sentence if the library makes less than 40 % of the multiply-adds; else empty.
  [[nodiscard]] std::string warning() const;
};
/// Measured once per process, by one thread and without starting others, so that a process may fork after it.
const BlasRate& blas_rate();

/// Products of odd sizes, also of transposed matrices, against a plain loop in double precision. Throws
/// InputError if one is wrong.
void require_right_products(const BlasFound& found);

}  // namespace swingbank::train::runtime
