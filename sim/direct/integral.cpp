#include "sim/direct/integral.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace swingbank::sim::direct {

Eigen::VectorXd integral(const Eigen::VectorXd& f, double step) {
  const Eigen::Index n = f.size();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n);
  if (n < 4) return sum;
  const double part = step / 24;
  // Integral of each interval by the cubic through the four neighbouring samples (Gregory).
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    double area = 0;
    if (k == 0)
      area = 9 * f[0] + 19 * f[1] - 5 * f[2] + f[3];
    else if (k + 2 == n)
      area = 9 * f[n - 1] + 19 * f[n - 2] - 5 * f[n - 3] + f[n - 4];
    else
      area = 13 * (f[k] + f[k + 1]) - f[k - 1] - f[k + 2];
    sum[k + 1] = sum[k] + part * area;
  }
  return sum;
}

double leap_limit(const Recording& record) {
  constexpr double kLeastLeap = 0.01, kShare = 0.2;  // [pu]; fraction of the largest change
  constexpr double kDeviations = 6;  // standard deviations of the difference of two noisy samples
  const auto& V = record.V;
  double largest = kLeastLeap;
  for (std::size_t k = 1; k < V.size(); ++k) largest = std::max(largest, std::abs(V[k] - V[k - 1]));
  return std::max(kShare * largest, kDeviations * std::numbers::sqrt2 * record.noise.phasor());
}

std::size_t behind_last_leap(const Recording& record) {
  const auto& V = record.V;
  const double limit = leap_limit(record);
  for (std::size_t k = V.size(); k-- > 1;)
    if (std::abs(V[k] - V[k - 1]) > limit) return k;
  return 0;
}

std::size_t before_first_leap(const Recording& record) {
  const auto& V = record.V;
  const double limit = leap_limit(record);
  for (std::size_t k = 1; k < V.size(); ++k)
    if (std::abs(V[k] - V[k - 1]) > limit) return k;
  return V.size();
}

}  // namespace swingbank::sim::direct
