#pragma once
// Weak form of the swing equation: integrals of the recorded signals with smooth test functions. The
// integrals need no derivative of a recorded signal and average the noise of many samples.
#include <Eigen/Dense>
#include <cstddef>
#include <string>
#include <vector>

#include "sim/core/frequency.hpp"

namespace swingbank::train::data {

/// Window of the integrals, and constants of the record.
struct SwingWindow {
  double rate = 0.0;                        ///< sampling rate of the record [1/s]
  double event_s = 0.0;                     ///< event time [s]; the record is steady before it
  double start_s = 0.0;                     ///< latest end of the fault [s]
  double end_s = 0.0;                       ///< latest end of the integrals [s]
  double system_frequency = 0.0;            ///< [Hz]
  sim::FrequencyFilter frequency_filter{};  ///< filter of the channel "frequency"
};

/// Terms of the weak swing equation. For a test function \f$ \phi \f$ that is zero at both ends of the
/// window,
///
/// \f[ -2H \int \phi' \omega + D \int \phi\, \omega = \int \phi\, (P_0 - P) \f]
///
/// with the speed deviation \f$ \omega \f$ [pu], the power P and its mean before the event P0 [pu on the
/// machine base]. The speed follows from the channel "speed" and, by integration by parts, from the rotor's
/// angle
/// \f$ \delta = \theta + \arg(V + jX'_d I) \f$:
///
/// \f[ \int\phi\,\omega = -\frac{1}{\omega_0}\int\phi'\delta, \qquad
///     \int\phi'\omega = -\frac{1}{\omega_0}\int\phi''\delta \f]
///
/// Term `one` is \f$ \int\phi \f$, the coefficient of an error of P0. Test functions are cosines and sines up
/// to 4 Hz with a taper of 0.3 s at both ends.
class SwingIntegrals {
 public:
  /// Terms in the order of the output.
  enum Term { power, speed, speed_derivative, angle, angle_derivative, one, terms };

  SwingIntegrals() = default;
  /// `names`: channels of the record. Throws InputError unless P, Q, V, speed and frequency are among them,
  /// or if the window starts before the event or is shorter than two tapers.
  SwingIntegrals(const std::vector<std::string>& names, const SwingWindow& window);

  [[nodiscard]] const SwingWindow& window() const { return window_; }
  /// Returns the number of test functions.
  [[nodiscard]] std::size_t functions() const { return static_cast<std::size_t>(value_.cols()); }
  /// Returns the number of used samples, counted from the record's first sample.
  [[nodiscard]] std::size_t samples() const;
  /// Computes the integrals of one row. `stride`: distance of its channels in `record` [samples]; `level`:
  /// noise level; `reactance`: X'd [pu on the machine base]; out: terms x functions().
  void apply(const float* record, std::size_t stride, double level, double reactance, float* out) const;

 private:
  [[nodiscard]] std::size_t first_sample(const float* V, double level) const;

  SwingWindow window_;
  /// Test functions and their first and second derivatives, times the sampling interval: [sample][function].
  Eigen::MatrixXd value_, derivative_, curvature_;
  std::size_t steady_ = 0, event_ = 0, start_ = 0;  ///< steady samples; indices of event_s and start_s
  int P_ = -1, Q_ = -1, V_ = -1, speed_ = -1, frequency_ = -1;
};

}  // namespace swingbank::train::data
