#pragma once
// What one event costs at a point of the fit, with slopes, as Ceres takes it. For fit.cpp only.
#include <limits>

#include "validate/fit/detail/cost.hpp"

namespace swingbank::validate::fit::fitting {

/// R, upper triangular, has the same products of columns as e: R'R = e'e. A column that the others make
/// leaves a zero row.
event::RowMatrix triangle_of(const event::RowMatrix& e);

/// What one event costs. The parameter blocks are z of the plant (absent if none is free) and the state of
/// the event. Ceres asks for nothing but products of residuals and slopes, so it gets the triangle that has
/// these products, with one row for each column instead of one for each value.
class EventCost : public ceres::CostFunction {
 public:
  EventCost(const Setting& setting, std::size_t event);
  [[nodiscard]] std::size_t state_size() const { return switching_numbers(event_) + kStates; }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;
  /// The event's state from the search's numbers.
  [[nodiscard]] EventState at(const double* state) const;
  /// What the plant answers to the event.
  [[nodiscard]] playin::Response answer(const sim::plant::Plant& plant, const EventState& state,
                                        bool lenient) const;
  /// Slopes are asked for at so many points at most from now on: behind the last step of a search nobody
  /// needs any, and zeros are given.
  void look_at(int points) { points_ = points; }
  /// Slopes are taken anew where they are asked for next, if they were gone on with.
  void renew() { renew_ = looked_.gone_on > 0; }

 private:
  bool evaluate(double const* const* blocks, double* residuals, double** jacobians) const;
  /// Whitened residuals of all values in the last column, and before it their sensitivities to z and to the
  /// state. Empty where the plant cannot be simulated.
  [[nodiscard]] event::RowMatrix values(const double* z, const double* state, bool slopes) const;
  /// Slopes of a plant that is linear about each step are per cents off, which stops a search where columns
  /// are nearly the same. How the residuals moved along a step, less what slopes foretell, is what these were
  /// off by along it; each column takes a share as large as its square (Broyden, Math. Comp. 19, 1965, p.
  /// 577, with each unknown in units of what it moves).
  [[nodiscard]] Eigen::MatrixXd by_column(const Eigen::VectorXd& missed, const Eigen::VectorXd& step) const;
  /// Whether the slopes taken before foretold the residuals at the last point well enough; they are those of
  /// the last point then.
  [[nodiscard]] bool foretold() const;
  /// Slopes at the last point, with what steps have shown them to be off by.
  void take(event::RowMatrix e) const;

  const Setting& setting_;
  const event::FitEvent& event_;
  const event::EventNoise& noise_;
  mutable bool renew_ = false;
  mutable int points_ = std::numeric_limits<int>::max();
  mutable std::vector<double> allowance_;  ///< see event::Playing
  /// The point that was evaluated last.
  struct Last {
    Eigen::VectorXd at, residual;
    std::shared_ptr<const playin::Past> past;
  };
  mutable Last last_;
  /// The point that has slopes: residuals and slopes there, what fresh slopes are off by, and how often those
  /// of the point before did.
  struct Looked {
    Eigen::VectorXd at;
    event::RowMatrix e, off;
    int gone_on = 0;
  };
  mutable Looked looked_;
};

}  // namespace swingbank::validate::fit::fitting
