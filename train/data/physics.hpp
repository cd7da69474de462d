#pragma once
// What a machine's equations are written in, formed from the recorded channels: currents, the voltage behind
// the subtransient reactance, and the integrals that carry the swing and the field's flux. A network that
// reads these need not learn to divide and to integrate.
#include <cstddef>
#include <string>
#include <vector>

namespace swingbank::train::data {

inline constexpr double kLeastVoltage = 1e-3;      ///< at a bolted fault the terminal may have none [pu]
inline constexpr double kNoisyLeastVoltage = 0.1;  ///< below it a current would be noise over noise [pu]

/// Where the machine's event lies in the record and what part of it is shown.
struct PhysicsWindow {
  double rate = 0.0;                     ///< of the record [1/s]
  double start_s = 0.0, end_s = 0.0;     ///< window [s]
  double event_s = 0.0;                  ///< instant before which the record is steady [s]
  double reactance = 0.0;                ///< X''d or X'd: what E lies behind [pu on the machine's base]
  double least_voltage = kLeastVoltage;  ///< that P and Q are divided by to get currents [pu]
};

/// Channels in this order: P/V, Q/V, V, E, angle of E against the terminal, integral of P; with a speed:
/// speed and its integral; with a field current: it and its integral; with speed and frequency: frequency and
/// the integral of their difference. All less their mean before the event. The samples are means over cells:
/// single samples until 1 s behind the event, 1/30 s until 5 s, 1/15 s from there on.
class Physics {
 public:
  Physics() = default;
  /// `names`: of the record's channels; P, Q and V must be among them (InputError).
  Physics(const std::vector<std::string>& names, const PhysicsWindow& window);

  [[nodiscard]] const PhysicsWindow& window() const { return window_; }
  [[nodiscard]] std::size_t channels() const;
  [[nodiscard]] std::size_t cells() const { return cells_.size(); }
  /// Steady values that follow the series: P, Q, V, E, its angle, and the field current where recorded.
  [[nodiscard]] std::size_t levels() const { return field_ >= 0 ? 6 : 5; }
  /// Samples of a record that are looked at, from its first.
  [[nodiscard]] std::size_t samples() const { return cells_.back().first + cells_.back().count; }
  /// Samples that each cell is the mean of.
  [[nodiscard]] std::vector<float> cell_samples() const;
  /// record: one row, its channels `stride` apart; out: channels() x cells(), then levels().
  void apply(const float* record, std::size_t stride, float* out) const;

 private:
  struct Cell {
    std::size_t first, count;
  };
  PhysicsWindow window_;
  std::vector<Cell> cells_;
  std::size_t steady_ = 1;  ///< samples before the event
  int P_ = -1, Q_ = -1, V_ = -1, speed_ = -1, field_ = -1, frequency_ = -1;
};

}  // namespace swingbank::train::data
