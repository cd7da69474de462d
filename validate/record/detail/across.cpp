#include "validate/record/detail/across.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace swingbank::validate::record {
namespace {

constexpr std::size_t kHighestDegree = 7;
constexpr double kRounding = 1e-9;  ///< RMS residual below which fits count as equal [pu, rad]

/// Values at the given abscissae, followed by values at the abscissae in the gap.
using Curve = std::vector<double>;

double dot(const Curve& a, const Curve& b, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}
void add(Curve& a, double part, const Curve& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += part * b[i];
}
/// Returns the corrected Akaike criterion of a fit to `count` values with `free` parameters (including the
/// noise variance) and the residual sum of squares `left`.
double criterion(double left, std::size_t count, std::size_t free) {
  const auto n = static_cast<double>(count), k = static_cast<double>(free);
  if (free + 1 >= count) return std::numeric_limits<double>::infinity();
  return n * std::log(left / n + kRounding * kRounding) + 2 * k * n / (n - k - 1);
}

}  // namespace

Across across(const std::vector<double>& at, const std::vector<double>& value,
              const std::vector<double>& inside) {
  const std::size_t n = at.size();
  Curve x = at;
  x.insert(x.end(), inside.begin(), inside.end());
  Curve rest = value;  // residual of the polynomial; in the gap, the negated polynomial
  rest.resize(x.size(), 0.0);
  Curve step(x.size()), before(x.size(), 0.0), now(x.size(), 1.0);
  std::ranges::transform(x, step.begin(), [](double t) { return t > 0 ? 1.0 : 0.0; });
  Across result;
  double smooth = std::numeric_limits<double>::infinity(), with_step = smooth, step_height = 0,
         norm_before = 1;
  for (std::size_t degree = 0; degree <= kHighestDegree; ++degree) {  // by Forsythe's orthogonal polynomials
    const double norm = dot(now, now, n);
    add(rest, -dot(rest, now, n) / norm, now);
    add(step, -dot(step, now, n) / norm, now);
    const double left = dot(rest, rest, n), of_step = dot(step, step, n), along = dot(rest, step, n);
    if (const double c = criterion(left, n, degree + 2); c < smooth) {
      smooth = c;
      result.inside.assign(rest.begin() + static_cast<std::ptrdiff_t>(n), rest.end());
    }
    if (of_step > kRounding)
      if (const double c = criterion(std::max(0.0, left - along * along / of_step), n, degree + 3);
          c < with_step)
        with_step = c, step_height = along / of_step;
    Curve next(x.size());
    std::ranges::transform(x, now, next.begin(), std::multiplies<>());
    add(next, -dot(next, now, n) / norm, now);
    if (degree > 0) add(next, -norm / norm_before, before);
    before = std::move(now), now = std::move(next), norm_before = norm;
  }
  for (double& y : result.inside) y = -y;
  if (with_step < smooth) result.step = step_height;
  return result;
}

}  // namespace swingbank::validate::record
