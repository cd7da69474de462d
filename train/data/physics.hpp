#pragma once
// Physical input signals, computed from the recorded channels: currents, the voltage behind the subtransient
// reactance, and the integrals in the swing and field flux equations. With these signals, a network need not
// learn division and integration.
#include <cstddef>
#include <string>
#include <vector>

namespace swingbank::train::data {

inline constexpr double kLeastVoltage = 1e-3;  ///< lower limit of V as a divisor, for bolted faults [pu]
/// Lower limit of V as a divisor for noisy records, below which noise dominates [pu].
inline constexpr double kNoisyLeastVoltage = 0.1;

/// Time of the event in the record, and the window of the input.
struct PhysicsWindow {
  double rate = 0.0;                     ///< sampling rate of the record [1/s]
  double start_s = 0.0, end_s = 0.0;     ///< window [s]
  double event_s = 0.0;                  ///< event time [s]; the record is steady before it
  double reactance = 0.0;                ///< X''d or X'd, between the terminal and E [pu on the machine base]
  double least_voltage = kLeastVoltage;  ///< lower limit of V as the divisor of P and Q [pu]
};

/// Computation of the signals. Channels in this order: P/V, Q/V, V, E (voltage behind the reactance), angle
/// of E relative to the terminal, integral of P. If recorded, the speed and its integral follow, then the
/// field current and its integral. If speed and frequency are recorded, frequency and the integral of their
/// difference follow. All signals are relative to their mean before the event. Samples are means over bins:
/// one sample of the record until 1 s after the event, 1/30 s until 5 s, then 1/15 s.
class Physics {
 public:
  Physics() = default;
  /// `names`: channels of the record. Throws InputError unless P, Q and V are among them.
  Physics(const std::vector<std::string>& names, const PhysicsWindow& window);

  [[nodiscard]] const PhysicsWindow& window() const { return window_; }
  [[nodiscard]] std::size_t channels() const;
  [[nodiscard]] std::size_t bins() const { return bins_.size(); }
  /// Returns the number of steady values after the series: P, Q, V, E, the angle of E, and the field current
  /// if recorded.
  [[nodiscard]] std::size_t levels() const { return field_ >= 0 ? 6 : 5; }
  /// Returns the number of used samples, counted from the record's first sample.
  [[nodiscard]] std::size_t samples() const { return bins_.back().first + bins_.back().count; }
  /// Returns the number of samples in each bin.
  [[nodiscard]] std::vector<float> bin_samples() const;
  /// Computes the input of one row. `stride`: distance of its channels in `record` [samples]; out: channels()
  /// x bins() values, then levels() values.
  void apply(const float* record, std::size_t stride, float* out) const;

 private:
  struct Bin {
    std::size_t first, count;
  };
  PhysicsWindow window_;
  std::vector<Bin> bins_;
  std::size_t steady_ = 1;  ///< samples before the event
  int P_ = -1, Q_ = -1, V_ = -1, speed_ = -1, field_ = -1, frequency_ = -1;
};

}  // namespace swingbank::train::data
