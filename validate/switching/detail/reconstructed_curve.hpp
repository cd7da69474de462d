#pragma once
// Reconstruction of a voltage with steps at given switching times from the averages of a filter.
#include <Eigen/Dense>
#include <vector>

#include "base/complex.hpp"
#include "validate/switching/filter_window.hpp"

namespace swingbank::validate::switching {

/// Filtered samples around some switchings, each a weighted average over a window.
struct FilteredSamples {
  std::vector<double> t;            ///< [s]
  std::vector<Complex> v;           ///< [pu]
  double magnitude = 0, angle = 0;  ///< noise of V [pu], noise of theta [rad]
  double step = 0;                  ///< sample interval [s]
};

/// Most probable voltage. Between switching times its second derivative is white noise of intensity
/// `roughness` [pu^2/s^3] (smoothing spline: G. Wahba, "Improper priors, spline smoothing and the problem of
/// guarding against model errors in regression", J. R. Stat. Soc. B 40, 1978). Its basis is cubic B-splines
/// with knots every half sample interval, or every eighth of the window's half-width if that is longer. The
/// voltage extends half a window beyond the samples at either end.
class ReconstructedCurve {
 public:
  /// `switching_times`: switching times in ascending order, between the first and the last sample [s].
  ReconstructedCurve(const FilteredSamples& stretch, const FilterWindow& window,
                     const std::vector<double>& switching_times, double roughness);
  /// Returns the log evidence of window, switching times and roughness, up to a constant.
  [[nodiscard]] double evidence() const { return evidence_; }
  /// Returns the voltage phasor [pu] at t [s] in segment 0 (before the first switching time), 1, ...
  [[nodiscard]] Complex operator()(int segment, double t) const;

 private:
  /// One segment: cubic spans of equal length, whose coefficients begin at `first`.
  struct Segment {
    double from, span;
    int spans, first;
  };
  void set_segments(const FilteredSamples& stretch, const FilterWindow& window,
                    const std::vector<double>& switching_times);
  [[nodiscard]] Eigen::MatrixXd averages(const FilteredSamples& stretch, const FilterWindow& window) const;
  /// Returns the prior precision of a segment's coefficients.
  [[nodiscard]] static Eigen::MatrixXd prior(const Segment& s, double roughness);
  std::vector<Segment> segments_;
  int count_ = 0;
  Eigen::MatrixXd coefficients_;  // [coefficient][real, imaginary]
  double evidence_ = 0;
};

}  // namespace swingbank::validate::switching
