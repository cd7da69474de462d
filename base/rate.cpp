#include "base/rate.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"

namespace swingbank {
namespace {

double wilson(const Rate& r, double sign) {
  if (r.n == 0) return sign < 0 ? 0.0 : 1.0;
  constexpr double z = constants::normal95;
  const double n = r.n, p = r.value(), zz = z * z / n;
  return (p + zz / 2 + sign * z * std::sqrt(p * (1 - p) / n + zz / (4 * n))) / (1 + zz);
}

}  // namespace

double Rate::low() const { return std::max(0.0, wilson(*this, -1)); }
double Rate::high() const { return std::min(1.0, wilson(*this, 1)); }

}  // namespace swingbank
