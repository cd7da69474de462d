#pragma once
// Cost of one event and its sensitivities as a Ceres cost function. For fit.cpp only.
#include <limits>

#include "validate/fit/detail/cost.hpp"

namespace swingbank::validate::fit::fitting {

/// Returns the upper triangular R with R'R = e'e. A column that depends linearly on earlier ones gives a zero
/// row.
noise::RowMatrix triangle_of(const noise::RowMatrix& e);

/// Cost of one event. The parameter blocks are the plant's z (absent if no parameter is free) and the event's
/// state. Ceres uses only products of residuals and sensitivities. It therefore receives a triangular factor
/// with the same products. The factor has one row per variable instead of one per compared value.
class EventCost : public ceres::CostFunction {
 public:
  EventCost(const Setting& setting, std::size_t event);
  [[nodiscard]] std::size_t state_size() const { return switching_numbers(event_) + kStates; }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;
  /// Returns the event's state from the search's variables.
  [[nodiscard]] EventState at(const double* state) const;
  /// Returns the response of the plant to the event.
  [[nodiscard]] playin::Response response(const sim::plant::Plant& plant, const EventState& state,
                                          bool lenient) const;
  /// Limits the number of points at which sensitivities are computed from now on. After the last step of a
  /// search they are not needed, and zeros are returned in their place.
  void look_at(int points) { points_ = points; }
  /// Requests new sensitivities at the next evaluation if the present ones were reused from an earlier point.
  void renew() { renew_ = looked_.gone_on > 0; }

 private:
  bool evaluate(double const* const* blocks, double* residuals, double** jacobians) const;
  /// Returns the whitened residuals in the last column, and their sensitivities to z and to the state in the
  /// columns before it. Empty if the plant cannot be simulated.
  [[nodiscard]] noise::RowMatrix values(const double* z, const double* state, bool with_sensitivities) const;
  /// Distributes the prediction error `missed` of a step over the columns of the sensitivities. Linearised
  /// sensitivities have errors of a few per cent, which stop a search along nearly collinear columns. Each
  /// column receives a share proportional to its squared norm (Broyden, Math. Comp. 19, 1965, p. 577, with
  /// each unknown scaled by its column's norm).
  [[nodiscard]] Eigen::MatrixXd by_column(const Eigen::VectorXd& missed, const Eigen::VectorXd& step) const;
  /// Returns whether the previous sensitivities predicted the residuals at the last point well enough. If
  /// they did, updates them and assigns them to the last point.
  [[nodiscard]] bool reuse_sensitivities() const;
  /// Stores new sensitivities at the last point, corrected by the prediction errors of earlier steps.
  void take(noise::RowMatrix e) const;

  const Setting& setting_;
  const event::FitEvent& event_;
  const noise::EventNoise& noise_;
  mutable bool renew_ = false;
  mutable int points_ = std::numeric_limits<int>::max();
  mutable std::vector<double> allowance_;  ///< see event::Playing
  /// The point of the last evaluation.
  struct Last {
    Eigen::VectorXd at, residual;
    std::shared_ptr<const playin::TrajectoryCache> cache;
  };
  mutable Last last_;
  /// The point at which the sensitivities apply. `e`: its sensitivities and residuals; `off`: correction of
  /// newly computed sensitivities; `gone_on`: number of reuses.
  struct Looked {
    Eigen::VectorXd at;
    noise::RowMatrix e, off;
    int gone_on = 0;
  };
  mutable Looked looked_;
};

}  // namespace swingbank::validate::fit::fitting
