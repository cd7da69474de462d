#pragma once
// Least squares of the inferred input on one or two courses, over all events together.
#include <Eigen/Dense>
#include <vector>

#include "validate/laws/candidate.hpp"

namespace swingbank::validate::laws {

/// Courses at the samples of the events, [event][sample].
using Course = std::vector<std::vector<double>>;

class LawRegression {
 public:
  explicit LawRegression(const std::vector<LawTrace>& traces);

  struct Answer {
    Eigen::VectorXd factors;
    double explained = 0, score = 0;
    Eigen::VectorXd course;  ///< at all knots, event after event
  };
  /// `numbers` says with how many numbers the courses were chosen, besides their factors.
  [[nodiscard]] Answer fit(const std::vector<Eigen::VectorXd>& columns, int numbers) const;
  /// A course as the input shows it: its mean around each knot, weighted as the straight pieces are.
  [[nodiscard]] Eigen::VectorXd at_knots(const Course& course) const;
  /// The same of a function of event and time.
  template <class F>
  [[nodiscard]] Eigen::VectorXd at_knots_of(F f) const {
    Course course(traces_.size());
    for (std::size_t e = 0; e < traces_.size(); ++e) {
      course[e].reserve(traces_[e].t.size());
      for (const double t : traces_[e].t) course[e].push_back(f(traces_[e], t));
    }
    return at_knots(course);
  }
  /// [event][knot]
  [[nodiscard]] std::vector<std::vector<double>> by_event(const Eigen::VectorXd& all) const;
  [[nodiscard]] const std::vector<LawTrace>& traces() const { return traces_; }

 private:
  struct Weight {
    int knot, sample;
    double share;
  };
  const std::vector<LawTrace>& traces_;
  std::vector<std::vector<Weight>> hats_;  ///< [event]
  Eigen::VectorXd target_, weight_;
  double total_ = 0, count_ = 0;
};

}  // namespace swingbank::validate::laws
