#pragma once
// Frequency as an instrument at the terminal sees it: the filtered derivative of the voltage angle.
//   f(s) = s theta(s) / (2 pi f0 (1 + s Tw)(1 + s Tf))          [pu deviation]
// By partial fractions it is the difference of two first-order lags of theta, over 2 pi f0 (Tf - Tw). Each
// lag is integrated exactly for an angle that runs linearly from sample to sample. It starts settled, so f(0)
// = 0. Where the caller holds theta (V = 0) the filter runs on.
#include <cmath>
#include <cstddef>

#include "base/constants.hpp"

namespace swingbank::sim {

struct FrequencyFilter {
  double washout = 0.1;  ///< Tw [s], must differ from Tf
  double filter = 0.02;  ///< Tf [s]
};

/// The filter sample by sample, on angles less the first one.
class FrequencyLags {
 public:
  FrequencyLags(double rate, double f0, const FrequencyFilter& constants)
      : washout_(constants.washout, 1.0 / rate),
        filter_(constants.filter, 1.0 / rate),
        scale_(1.0 / (constants::turn * f0 * (constants.filter - constants.washout))) {}
  /// Frequency deviation [pu] where the angle goes on to u [rad].
  double frequency(double u) {
    const double f = scale_ * (washout_.step(last_, u) - filter_.step(last_, u));
    last_ = u;
    return f;
  }
  /// The angle [rad] that makes the frequency deviation f [pu]: the exact inverse, which is stable.
  double angle(double f) {
    const double held = washout_.keep * washout_.x - filter_.keep * filter_.x;
    const double u =
        (f / scale_ - held - (washout_.before - filter_.before) * last_) / (washout_.after - filter_.after);
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

/// theta: `samples` angles [rad] at `rate` [1/s], wrapped to +-pi or not; out: frequency deviation [pu of
/// f0].
inline void terminal_frequency(const double* theta, std::size_t samples, double rate, double f0,
                               const FrequencyFilter& constants, double* out) {
  FrequencyLags lags(rate, f0, constants);
  double turned = 0.0;
  if (samples > 0) out[0] = 0.0;
  for (std::size_t k = 1; k < samples; ++k) {
    const double jump = theta[k] - theta[k - 1];
    turned -= constants::turn *
              std::round(jump / constants::turn);  // an angle does not leap by half a turn between samples
    out[k] = lags.frequency(theta[k] - theta[0] + turned);
  }
}

/// The angle [rad], less the first one, of a terminal's frequency deviation as terminal_frequency() gives it.
inline void terminal_angle(const double* frequency, std::size_t samples, double rate, double f0,
                           const FrequencyFilter& constants, double* theta) {
  FrequencyLags lags(rate, f0, constants);
  if (samples > 0) theta[0] = 0.0;
  for (std::size_t k = 1; k < samples; ++k) theta[k] = lags.angle(frequency[k]);
}

}  // namespace swingbank::sim
