#pragma once
// A record with its switching times and operating point, prepared for fitting.
#include <Eigen/Dense>
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "validate/playin/plant_playback.hpp"
#include "validate/switching/switching.hpp"

namespace swingbank::validate::event {

/// Cached voltage curve of an event that does not change. A copy of the event may change, so it has no cached
/// curve.
class KeptCurve {
 public:
  KeptCurve() = default;
  /// Takes ownership of the curve; null: none.
  explicit KeptCurve(std::unique_ptr<const playin::VoltageCurve> curve) : curve_(std::move(curve)) {}
  /// A copy starts without a curve.
  KeptCurve(const KeptCurve&) {}
  /// Moves the curve.
  KeptCurve(KeptCurve&&) = default;
  /// Removes the curve, since the event is overwritten.
  KeptCurve& operator=(const KeptCurve& other) {
    if (this != &other) curve_.reset();
    return *this;
  }
  /// Moves the curve.
  KeptCurve& operator=(KeptCurve&&) = default;
  ~KeptCurve() = default;
  /// Returns the curve; null if there is none.
  [[nodiscard]] const playin::VoltageCurve* get() const { return curve_.get(); }

 private:
  std::unique_ptr<const playin::VoltageCurve> curve_;
};

/// One event, prepared for fitting.
struct FitEvent : switching::SwitchedRecord {
  playin::OperatingPoint start = {};  ///< operating point before the event
  /// 1 for samples that are not compared: filtered samples, lost samples, samples after a switching whose
  /// frequency was replaced (drop_peaks), and samples next to a switching at an uncertain time, because a
  /// delay of 1 ms may move them across the switching. Empty: all are compared.
  std::vector<char> left_out = {};
  std::vector<playin::Output> channels = {};  ///< compared channels, see playin::compared_outputs()
  KeptCurve kept = {};  ///< cached curve of played() with `switchings`, see keep_curve()
  /// Caches the voltage curve of an event that does not change any more. An invalid voltage is not cached;
  /// play() then reports the reason.
  void keep_curve();
  /// Returns the played-in voltage with the given switchings.
  [[nodiscard]] playin::VoltageCurve curve(std::vector<switching::Switching> at) const;
  /// Returns an output or a sensitivity of Response ([output][sample]) at the compared samples, in the order
  /// [sample * channels + channel]. If `less_measured`, the measured values are subtracted.
  [[nodiscard]] Eigen::VectorXd collected(const std::vector<double>* values, bool less_measured) const;
  /// Returns the recorded samples of a channel, in the unit of Response.
  [[nodiscard]] const std::vector<double>& measured(playin::Output o) const;
  /// Returns whether the angle has an unknown phase jump at each switching, because it was integrated from a
  /// frequency.
  [[nodiscard]] bool turns() const;
  /// Returns the played-in record.
  [[nodiscard]] const record::Record& played() const { return filtered_samples.empty() ? record : clean; }
  /// Returns whether a sample is compared.
  [[nodiscard]] bool compared(std::size_t sample) const { return left_out.empty() || !left_out[sample]; }
  /// Returns the number of compared values.
  [[nodiscard]] int values() const {
    const auto missing = std::ranges::count(left_out, 1);
    return (record.samples() - static_cast<int>(missing)) * static_cast<int>(channels.size());
  }
};

}  // namespace swingbank::validate::event
