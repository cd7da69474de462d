// Noise bounds of an error map: quantiles of the F distribution by the incomplete beta function.
#include <cmath>

#include "validate/compare/error_map.hpp"

namespace swingbank::validate::compare {
namespace {

/// Continued fraction of the incomplete beta function (Abramowitz & Stegun 26.5.8) by Lentz's method.
double beta_fraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;
  const auto guarded = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
  double c = 1, d = 1 / guarded(1 - (a + b) * x / (a + 1)), f = d;
  for (int m = 1; m < 10000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / guarded(1 + even * d);
    c = guarded(1 + even / c);
    f *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / guarded(1 + odd * d);
    c = guarded(1 + odd / c);
    f *= d * c;
    if (std::abs(d * c - 1) < 1e-14) break;
  }
  return f;
}

/// Regularised incomplete beta function I_x(a, b).
double incomplete_beta(double a, double b, double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a
                                   : 1 - front * beta_fraction(b, a, 1 - x) / b;
}

}  // namespace

double noise_bound(int values, int freedom, double probability) {
  // A known variance is the limit of many degrees of freedom.
  const double m = values, nu = freedom > 0 ? freedom : 1e9;
  const auto tail = [&](double f) { return incomplete_beta(nu / 2, m / 2, nu / (nu + m * f)); };
  double low = 1e-6, high = 10;
  while (tail(high) > probability && high < 1e12) high *= 10;
  for (int i = 0; i < 200 && high / low > 1 + 1e-12; ++i) {
    const double middle = std::sqrt(low * high);
    (tail(middle) > probability ? low : high) = middle;
  }
  return std::sqrt(std::sqrt(low * high));
}

}  // namespace swingbank::validate::compare
