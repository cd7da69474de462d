#pragma once
// Interpolation of uniform samples, as input of the instrument models.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace swingbank::sim {

/// Interpolating curve: a Catmull-Rom cubic where the samples are smooth, a straight line across a step. The
/// sides of a step do not influence each other. Outside the samples the curve is constant. T: double or
/// complex.
template <class T>
class SampledCurve {
 public:
  /// Constructs the curve. The samples `y` are referenced, not copied, and must outlive it.
  explicit SampledCurve(std::span<const T> y) : y_(y), derivative_(y.size(), T{}) {
    for (std::ptrdiff_t k = 0; k < size(); ++k) {
      const bool left = k > 0 && !is_step(k - 1), right = k + 1 < size() && !is_step(k);
      if (left && right)
        derivative_[index(k)] = 0.5 * (at(k + 1) - at(k - 1));
      else if (left || right)
        derivative_[index(k)] = left ? at(k) - at(k - 1) : at(k + 1) - at(k);
    }
  }

  /// Returns the value at a position [samples].
  [[nodiscard]] T operator()(double position) const {
    const double place = std::clamp(position, 0.0, static_cast<double>(size() - 1));
    const auto k = std::min(static_cast<std::ptrdiff_t>(place), size() - 2);
    const double u = place - static_cast<double>(k);
    if (k < 0 || u == 0.0) return at(k < 0 ? 0 : k);
    const T rise = at(k + 1) - at(k);
    if (is_step(k)) return at(k) + u * rise;
    const T a = derivative_[index(k)] - rise, b = rise - derivative_[index(k + 1)];
    return at(k) + u * (rise + (1.0 - u) * ((1.0 - u) * a + u * b));
  }

 private:
  /// Whether there is a step between samples k and k + 1. A step is a change more than `kFarMore` times as
  /// large as the changes before and after it.
  [[nodiscard]] bool is_step(std::ptrdiff_t k) const {
    constexpr double kFarMore = 8.0;
    const double rise = std::norm(at(k + 1) - at(k));
    const double before = k > 0 ? std::norm(at(k) - at(k - 1)) : 0.0;
    const double after = k + 2 < size() ? std::norm(at(k + 2) - at(k + 1)) : 0.0;
    return rise > kFarMore * kFarMore * std::max(before, after);
  }
  [[nodiscard]] static std::size_t index(std::ptrdiff_t k) { return static_cast<std::size_t>(k); }
  [[nodiscard]] std::ptrdiff_t size() const { return static_cast<std::ptrdiff_t>(y_.size()); }
  [[nodiscard]] T at(std::ptrdiff_t k) const { return y_[index(k)]; }

  std::span<const T> y_;
  std::vector<T> derivative_;
};

}  // namespace swingbank::sim
