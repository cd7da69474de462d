#pragma once
// Weighted linear regression of the inferred input on one or more time series, over all events together.
#include <Eigen/Dense>
#include <vector>

#include "validate/user_model_search/candidate.hpp"

namespace swingbank::validate::user_model_search {

/// Time series at the samples of the events: [event][sample].
using TimeSeries = std::vector<std::vector<double>>;

/// Regression of the inferred input of all events on candidate time series.
class UserModelRegression {
 public:
  /// Prepares the regression on the inferred inputs of all events.
  explicit UserModelRegression(const std::vector<UserModelTrace>& traces);

  /// Result of a regression.
  struct Result {
    Eigen::VectorXd factors;  ///< factor of each column
    double explained = 0, score = 0;
    ///< coefficient of determination; Bayesian information criterion, lower is better
    Eigen::VectorXd time_series;  ///< at all knots, event after event
  };
  /// Regresses the input on `columns`. `numbers`: how many further parameters of the columns (time constant,
  /// width, ...) were selected.
  [[nodiscard]] Result fit(const std::vector<Eigen::VectorXd>& columns, int numbers) const;
  /// Returns a time series at the knots: its mean over each knot's hat function.
  [[nodiscard]] Eigen::VectorXd at_knots(const TimeSeries& time_series) const;
  /// Returns a function of trace and time at the knots, averaged in the same way.
  template <class F>
  [[nodiscard]] Eigen::VectorXd at_knots_of(F f) const {
    TimeSeries time_series(traces_.size());
    for (std::size_t e = 0; e < traces_.size(); ++e) {
      time_series[e].reserve(traces_[e].t.size());
      for (const double t : traces_[e].t) time_series[e].push_back(f(traces_[e], t));
    }
    return at_knots(time_series);
  }
  /// Splits a time series over all knots by event: [event][knot].
  [[nodiscard]] std::vector<std::vector<double>> by_event(const Eigen::VectorXd& all) const;
  /// Returns the traces.
  [[nodiscard]] const std::vector<UserModelTrace>& traces() const { return traces_; }

 private:
  struct Weight {
    int knot, sample;
    double share;
  };
  const std::vector<UserModelTrace>& traces_;
  std::vector<std::vector<Weight>> hats_;  ///< [event]
  Eigen::VectorXd target_, weight_;
  double total_ = 0, count_ = 0;
};

}  // namespace swingbank::validate::user_model_search
