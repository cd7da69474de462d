#pragma once
// Frequency as measured at the terminal: the filtered derivative of the voltage angle.
//   f(s) = s theta(s) / (2 pi f0 (1 + s Tw)(1 + s Tf))          [pu deviation]
// By partial fractions this is the difference of two first-order lags of theta, divided by 2 pi f0 (Tf - Tw).
// Each lag is integrated exactly for an angle that is linear between samples. The filter starts in steady
// state, so f(0) = 0. While V = 0, the caller keeps theta constant and the filter continues.
#include <cmath>
#include <cstddef>

#include "base/constants.hpp"

namespace swingbank::sim {

/// Time constants of the frequency measurement: washout Tw and filter Tf.
struct FrequencyFilter {
  double washout = 0.1;  ///< Tw [s], must differ from Tf
  double filter = 0.02;  ///< Tf [s]
};

/// Filter of the frequency measurement, evaluated sample by sample. Angles are relative to the first one.
class FrequencyLags {
 public:
  /// Constructs the filter in steady state. rate: samples per second [1/s]; f0: nominal frequency [Hz].
  FrequencyLags(double rate, double f0, const FrequencyFilter& constants)
      : washout_(constants.washout, 1.0 / rate),
        filter_(constants.filter, 1.0 / rate),
        scale_(1.0 / (constants::turn * f0 * (constants.filter - constants.washout))) {}
  /// Returns the frequency deviation [pu] at the next sample, whose angle is `u` [rad].
  double frequency(double u) {
    const double f = scale_ * (washout_.step(last_, u) - filter_.step(last_, u));
    last_ = u;
    return f;
  }
  /// Returns the angle [rad] at the next sample, whose frequency deviation is `f` [pu]. This is the exact and
  /// stable inverse of frequency().
  double angle(double f) {
    const double from_states = washout_.keep * washout_.x - filter_.keep * filter_.x;
    const double u = (f / scale_ - from_states - (washout_.before - filter_.before) * last_) /
                     (washout_.after - filter_.after);
    washout_.step(last_, u);
    filter_.step(last_, u);
    return last_ = u;
  }

 private:
  struct Lag {
    double keep, before, after, x;  // x <- keep x + before u_k + after u_k+1
    Lag(double T, double h) : keep(std::exp(-h / T)), x(0.0) {
      const double ramp = T / h * (1.0 - keep);
      before = ramp - keep;
      after = 1.0 - ramp;
    }
    double step(double u0, double u1) { return x = keep * x + before * u0 + after * u1; }
  };
  Lag washout_, filter_;
  double scale_, last_ = 0.0;
};

/// Computes the frequency deviation [pu of f0] of `samples` angles `theta` [rad] at `rate` [1/s] into `out`.
/// The angles may be wrapped to +-pi.
inline void terminal_frequency(const double* theta, std::size_t samples, double rate, double f0,
                               const FrequencyFilter& constants, double* out) {
  FrequencyLags lags(rate, f0, constants);
  double turned = 0.0;
  if (samples > 0) out[0] = 0.0;
  for (std::size_t k = 1; k < samples; ++k) {
    const double change = theta[k] - theta[k - 1];
    // Unwraps: the angle changes by less than half a turn per sample.
    turned -= constants::turn * std::round(change / constants::turn);
    out[k] = lags.frequency(theta[k] - theta[0] + turned);
  }
}

/// Computes the angles `theta` [rad], relative to the first one, from the frequency deviation [pu]. This is
/// the inverse of terminal_frequency().
inline void terminal_angle(const double* frequency, std::size_t samples, double rate, double f0,
                           const FrequencyFilter& constants, double* theta) {
  FrequencyLags lags(rate, f0, constants);
  if (samples > 0) theta[0] = 0.0;
  for (std::size_t k = 1; k < samples; ++k) theta[k] = lags.angle(frequency[k]);
}

}  // namespace swingbank::sim
