#pragma once
// Noise model of a set of events, which defines the unit of residuals and costs. Each estimation returns a
// distinct model. Two costs are comparable only if they use the same model.
#include <Eigen/Dense>
#include <memory>
#include <utility>
#include <vector>

#include "validate/noise/innovations.hpp"

namespace swingbank::validate::noise {

/// Noise of one event's channels.
struct EventNoise {
  Eigen::VectorXd deviation;  ///< standard deviation per channel [pu]
  Eigen::MatrixXd whitening;  ///< W, lower triangular: W e has unit covariance if e is white noise
  std::shared_ptr<const Innovations> memory = nullptr;  ///< whitening filter of coloured noise; null: white
  /// Whitens residuals or sensitivities in place: [compared sample * channels + channel][column].
  void whiten(RowMatrix& e) const;
};

/// Noise estimate of several events. Copies share the estimate.
class NoiseModel {
 public:
  /// Constructs an empty model: no noise has been estimated.
  NoiseModel() = default;
  /// Constructs a distinct estimate from the noise of each event.
  explicit NoiseModel(std::vector<EventNoise> events)
      : measured_(std::make_shared<const std::vector<EventNoise>>(std::move(events))) {}
  /// Noise of one event.
  [[nodiscard]] const EventNoise& of(std::size_t event) const { return measured_->at(event); }
  /// Number of events.
  [[nodiscard]] std::size_t size() const { return measured_ ? measured_->size() : 0; }
  /// Returns whether both objects share one estimate; equal numbers do not suffice.
  friend bool operator==(const NoiseModel&, const NoiseModel&) = default;

 private:
  std::shared_ptr<const std::vector<EventNoise>> measured_;
};

/// Throws std::logic_error if the two estimates are not the same: costs in their units are not comparable.
void require_same(const NoiseModel& a, const NoiseModel& b);

}  // namespace swingbank::validate::noise
