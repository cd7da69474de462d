#pragma once
// Moving averages of uniform samples over a window given in seconds, so that the result is independent of the
// sampling rate.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/constants.hpp"

namespace swingbank::sim {

/// Cubic convolution kernel: weight of a sample at a distance of `u` samples. It reproduces parabolas (R. G.
/// Keys, "Cubic convolution interpolation for digital image processing", IEEE Trans. ASSP 29, 1981).
inline double cubic_convolution(double u) {
  const double a = std::fabs(u);
  if (a <= 1.0) return (1.5 * a - 2.5) * a * a + 1.0;
  return a < 2.0 ? ((-0.5 * a + 2.5) * a - 4.0) * a + 2.0 : 0.0;
}

/// Returns the weights of the samples at distance k = 0, 1, ... for an average with the even window w(t),
/// |t| < half [s]. Between the samples, `step` [s] apart, the curve is interpolated by cubic convolution. The
/// weights are normalised: weight 0 plus twice the sum of the others is 1. half = 0 gives {1}.
template <class Window>
std::vector<double> window_weights(const Window& w, double half, double step) {
  constexpr std::array<double, 4> place = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                           0.9602898564975363};  // Gauss-Legendre, 8 points
  constexpr std::array<double, 4> weight = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                            0.1012285362903763};
  const double reach = half / step;  // all distances below are in samples
  const auto integral = [&](double a, double b, double k) {
    double sum = 0.0;
    const double middle = 0.5 * (a + b), radius = 0.5 * (b - a);
    for (std::size_t i = 0; i < place.size(); ++i)
      for (const double u : {middle - radius * place[i], middle + radius * place[i]})
        sum += weight[i] * w(u * step) * cubic_convolution(u - k);
    return sum * radius;
  };
  if (!(half > 0.0)) return {1.0};
  std::vector<double> weights;
  double total = 0.0;
  for (int k = 0; k - 2 < reach; ++k) {
    double sum = 0.0;
    for (int piece = k - 2; piece < k + 2; ++piece) {
      const double a = std::max<double>(piece, -reach), b = std::min<double>(piece + 1, reach);
      if (b > a) sum += integral(a, b, k);
    }
    weights.push_back(sum);
    total += k == 0 ? sum : 2.0 * sum;
  }
  for (double& one : weights) one /= total;
  return weights;
}

/// Returns the moving averages of `y` with the weights of window_weights(). Beyond the ends the first and
/// last samples are repeated. T: double or complex.
template <class T>
std::vector<T> averaged(const std::vector<T>& y, const std::vector<double>& weights) {
  const auto last = static_cast<std::ptrdiff_t>(y.size()) - 1;
  const auto at = [&](std::ptrdiff_t k) {
    return y[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
  };
  std::vector<T> out(y.size());
  for (std::ptrdiff_t k = 0; k <= last; ++k) {
    T sum = weights[0] * at(k);
    for (std::size_t j = 1; j < weights.size(); ++j) {
      const auto d = static_cast<std::ptrdiff_t>(j);
      sum += weights[j] * (at(k - d) + at(k + d));
    }
    out[static_cast<std::size_t>(k)] = sum;
  }
  return out;
}

/// Returns angles [rad] that are continuous from sample to sample; NaN stays NaN.
template <class Complex>
std::vector<double> continuous_angles(const std::vector<Complex>& phasors) {
  std::vector<double> angles;
  double last = 0.0;
  for (const Complex& v : phasors) {
    const double angle = std::arg(v),
                 near = angle + constants::turn * std::nearbyint((last - angle) / constants::turn);
    if (std::isfinite(near)) last = near;
    angles.push_back(near);
  }
  return angles;
}

/// Returns the frequency deviation [pu] of angles [rad]: central difference, one-sided at the ends.
inline std::vector<double> frequency_deviation(const std::vector<double>& angles, double rate,
                                               double frequency) {
  std::vector<double> df(angles.size(), 0.0);
  for (std::size_t k = 0; k < angles.size(); ++k) {
    const std::size_t a = k > 0 ? k - 1 : k, b = std::min(k + 1, angles.size() - 1);
    if (b > a)
      df[k] = (angles[b] - angles[a]) * rate / (static_cast<double>(b - a) * constants::turn * frequency);
  }
  return df;
}

}  // namespace swingbank::sim
