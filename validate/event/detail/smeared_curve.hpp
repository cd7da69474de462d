#pragma once
// The voltage that jumps at given instants and is smooth between them, by the averages that a filter has made
// of it.
#include <Eigen/Dense>
#include <vector>

#include "base/complex.hpp"
#include "validate/event/detail/filter_window.hpp"

namespace swingbank::validate::event {

/// Samples about some switchings, each an average over a window.
struct SmearedStretch {
  std::vector<double> t;            ///< [s]
  std::vector<Complex> v;           ///< [pu]
  double magnitude = 0, angle = 0;  ///< noise of V [pu], noise of theta [rad]
  double step = 0;                  ///< between samples [s]
};

/// The most probable voltage. Between instants its second derivative is white noise of intensity `roughness`
/// [pu^2/s^3] (a smoothing spline: G. Wahba, "Improper priors, spline smoothing and the problem of guarding
/// against model errors in regression", J. R. Stat. Soc. B 40, 1978), written in cubic B-splines of half a
/// sample, or of an eighth of the window where that is longer. It goes on for half a window beyond the
/// stretch.
class SmearedCurve {
 public:
  /// The instants are ascending and lie within the stretch.
  SmearedCurve(const SmearedStretch& stretch, const FilterWindow& window, const std::vector<double>& instants,
               double roughness);
  /// Logarithm of the probability of the samples, given window, instants and roughness, but for a constant.
  [[nodiscard]] double evidence() const { return evidence_; }
  /// Voltage phasor [pu] at t [s] in segment 0 (before the first instant), 1, ...
  [[nodiscard]] Complex operator()(int segment, double t) const;

 private:
  /// A segment: spans of one cubic each, whose coefficients begin at `first`.
  struct Segment {
    double from, span;
    int spans, first;
  };
  void set_segments(const SmearedStretch& stretch, const FilterWindow& window,
                    const std::vector<double>& instants);
  [[nodiscard]] Eigen::MatrixXd averages(const SmearedStretch& stretch, const FilterWindow& window) const;
  [[nodiscard]] Eigen::MatrixXd prior(double roughness) const;
  std::vector<Segment> segments_;
  int count_ = 0;
  Eigen::MatrixXd coefficients_;  // [coefficient][real, imaginary]
  double evidence_ = 0;
};

}  // namespace swingbank::validate::event
