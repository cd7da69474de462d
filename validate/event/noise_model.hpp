#pragma once
// The noise of a set of events as one value: what a residual is measured in. Each measurement makes a value
// of its own, and two costs may be compared only if both were taken with the same one.
#include <Eigen/Dense>
#include <memory>
#include <utility>
#include <vector>

#include "validate/event/innovations.hpp"

namespace swingbank::validate::event {

/// The noise of one event's channels.
struct EventNoise {
  Eigen::VectorXd deviation;  ///< standard deviation per channel [pu]
  Eigen::MatrixXd whitening;  ///< W, lower triangular: W e has unit covariance where e is white noise
  std::shared_ptr<const Innovations> memory = nullptr;  ///< memory of the noise, where it is not white
  /// Whitens residuals, or changes of the answer, in place: [compared sample * channels + channel][column].
  void whiten(RowMatrix& e) const;
};

class NoiseModel {
 public:
  /// No noise has been measured.
  NoiseModel() = default;
  /// A measurement of its own, with the noise of each event.
  explicit NoiseModel(std::vector<EventNoise> events)
      : measured_(std::make_shared<const std::vector<EventNoise>>(std::move(events))) {}
  [[nodiscard]] const EventNoise& of(std::size_t event) const { return measured_->at(event); }
  [[nodiscard]] std::size_t size() const { return measured_ ? measured_->size() : 0; }
  /// Whether both are one and the same measurement; equal numbers do not make them so.
  friend bool operator==(const NoiseModel&, const NoiseModel&) = default;

 private:
  std::shared_ptr<const std::vector<EventNoise>> measured_;
};

}  // namespace swingbank::validate::event
