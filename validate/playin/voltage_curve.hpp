#pragma once
// Recorded terminal voltage as a function of time: smooth between switching times, discontinuous at them.
#include <memory>
#include <vector>

#include "base/complex.hpp"
#include "validate/record/record.hpp"
#include "validate/switching/switching.hpp"

namespace swingbank::validate::playin {

using switching::Switching;

/// Cubic spline (not-a-knot) through the voltage phasors of each segment, extrapolated to its ends. Phasors
/// are interpolated because they remain smooth when V is near zero and theta changes fast. In segments of 3,
/// 2 or 1 points, the curve is the parabola, line or constant through them.
class VoltageCurve {
 public:
  /// Throws InputError if a switching is outside the record or a segment contains no point.
  VoltageCurve(const record::Record& record, std::vector<Switching> switchings);

  /// Returns the curve of the same record with other switching times. It shares the splines if no one-sided
  /// voltage is known and every switching time stays within its uncertainty, or between the same samples. A
  /// voltage reconstructed from filtered samples may have knots closer to a switching time than the
  /// uncertainty of that time. These knots remain in their segment. Throws as the constructor.
  [[nodiscard]] VoltageCurve moved(const record::Record& record, std::vector<Switching> switchings) const;

  /// Returns the curve with the angle advanced to theta + lead d(theta)/dt at every knot; `lead` in s.
  [[nodiscard]] VoltageCurve advanced(double lead) const;

  /// Number of segments.
  [[nodiscard]] int segments() const { return static_cast<int>(segments_->size()); }
  /// Returns the end of a segment [s], which is the start of the next.
  [[nodiscard]] double end(int segment) const {
    const auto s = static_cast<std::size_t>(segment);
    return s < switchings_.size() ? switchings_[s].time : last_;
  }
  /// Returns the voltage phasor [pu] of the given segment at t [s].
  [[nodiscard]] Complex operator()(int segment, double t) const;
  /// Returns the switchings, which separate the segments.
  [[nodiscard]] const std::vector<Switching>& switchings() const { return switchings_; }

 private:
  struct Segment {
    std::vector<double> t;
    std::vector<Complex> v, second_derivative;  ///< knots and second derivatives there
    double rate = 0;  ///< mean number of inner knots per second, to find an interval; 0: fewer than 4 knots
  };
  static void fit(Segment& segment);
  [[nodiscard]] static Complex slope(const Segment& segment, std::size_t knot);
  static std::size_t interval(const Segment& segment, double t);
  std::vector<Switching> switchings_;
  double last_ = 0;  ///< end of the record [s]
  std::shared_ptr<const std::vector<Segment>> segments_;
};

}  // namespace swingbank::validate::playin
