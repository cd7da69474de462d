#pragma once
// The recorded terminal voltage as a function of time: smooth between switching instants, never across one.
#include <memory>
#include <vector>

#include "base/complex.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::playin {

/// An instant at which the network changed. The voltage jumps there; samples at `time` itself count as before
/// it.
struct Switching {
  double time = 0;         ///< [s]
  double uncertainty = 0;  ///< it lies within time ± uncertainty [s]; 0: known
  bool has_before = false, has_after = false;
  Complex before{}, after{};  ///< one-sided voltages at `time` [pu], where they are known
  double turn = 0;            ///< what the record's angle lacks from here on, if it was not measured [rad]
};

/// Steps of the voltage larger than this [pu] in one sample interval are taken for switching.
constexpr double kJumpThreshold = 0.02;

/// Finds the sample intervals in which the voltage jumps: its step differs from both neighbouring steps by
/// more than `threshold` [pu] and more than ten times the usual difference (noise). Each is placed in the
/// middle of its interval, with half the interval as uncertainty. Where there is none: lone_jumps().
std::vector<Switching> detect_switchings(const record::Record& record, double threshold = kJumpThreshold);

/// Cubic spline (not-a-knot) through the voltage phasors of each segment, extrapolated to its ends. Phasors,
/// not V and theta: they stay smooth where V is near zero and theta turns. Segments of 3, 2 or 1 points get
/// the parabola, line or constant through them.
class VoltageCurve {
 public:
  /// Throws InputError if switchings lie outside the record or leave a segment without any point.
  VoltageCurve(const record::Record& record, std::vector<Switching> switchings);

  /// The curve of the same record with its instants moved. It shares the splines where no one-sided voltage
  /// is known and every instant stays within its uncertainty or every sample on its side: a voltage that was
  /// brought back from behind a filter has knots nearer to an instant than that is known, and they belong to
  /// the segment that they were made for. Throws as the constructor.
  [[nodiscard]] VoltageCurve moved(const record::Record& record, std::vector<Switching> switchings) const;

  [[nodiscard]] int segments() const { return static_cast<int>(segments_->size()); }
  /// Last instant of a segment [s]; the first instant of the next.
  [[nodiscard]] double end(int segment) const {
    const auto s = static_cast<std::size_t>(segment);
    return s < switchings_.size() ? switchings_[s].time : last_;
  }
  /// Voltage phasor [pu] of the given segment at t [s].
  [[nodiscard]] Complex operator()(int segment, double t) const;
  [[nodiscard]] const std::vector<Switching>& switchings() const { return switchings_; }

 private:
  struct Segment {
    std::vector<double> t;
    std::vector<Complex> v, slope2;  ///< knots and second derivatives there
    double rate = 0;                 ///< inner knots per second, all but evenly spaced; 0: too few
  };
  static void fit(Segment& segment);
  static std::size_t interval(const Segment& segment, double t);
  std::vector<Switching> switchings_;
  double last_ = 0;  ///< of the record [s]
  std::shared_ptr<const std::vector<Segment>> segments_;
};

}  // namespace swingbank::validate::playin
