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

/// theta: `samples` angles [rad] at `rate` [1/s], wrapped to +-pi or not; out: frequency deviation [pu of
/// f0].
inline void terminal_frequency(const double* theta, std::size_t samples, double rate, double f0,
                               const FrequencyFilter& constants, double* out) {
  struct Lag {
    double keep, before, after, x;  // x <- keep x + before u_k + after u_k+1, in angles less the first
    Lag(double T, double h) : keep(std::exp(-h / T)), x(0.0) {
      const double ramp = T / h * (1.0 - keep);
      before = ramp - keep;
      after = 1.0 - ramp;
    }
    double step(double u0, double u1) { return x = keep * x + before * u0 + after * u1; }
  };
  Lag w(constants.washout, 1.0 / rate), f(constants.filter, 1.0 / rate);
  const double scale = 1.0 / (constants::turn * f0 * (constants.filter - constants.washout));
  double turned = 0.0, last = 0.0;
  if (samples > 0) out[0] = 0.0;
  for (std::size_t k = 1; k < samples; ++k) {
    const double jump = theta[k] - theta[k - 1];
    turned -= constants::turn *
              std::round(jump / constants::turn);  // an angle does not leap by half a turn between samples
    const double u = theta[k] - theta[0] + turned;
    out[k] = scale * (w.step(last, u) - f.step(last, u));
    last = u;
  }
}

}  // namespace swingbank::sim
