#pragma once
// What an input that is free in time is worth: Laplace's evidence of its course, averaged over how much it
// may bend.
#include <Eigen/Dense>
#include <vector>

namespace swingbank::validate::fit::fitting {

/// Curvature of a fit with an input, event by event; z are the plant's parameters, an event's state ends with
/// the knots of its input.
class InputEvidence {
 public:
  /// Parameters with what is believed of them: precision of each and its value, both in z.
  InputEvidence(const Eigen::VectorXd& precision, const Eigen::VectorXd& z);
  /// Adds an event: slopes of its whitened residuals by z and by its state, the residuals, the precision of
  /// the state's numbers before the knots, and the knots' values.
  void add(const Eigen::MatrixXd& by_z, const Eigen::MatrixXd& by_state, const Eigen::VectorXd& residuals,
           const Eigen::VectorXd& precision, const Eigen::VectorXd& input);
  /// -2 log of the evidence of chi2, of the parameters and of the input (Laplace's approximation; MacKay,
  /// Neural Computation 4, 1992, p. 415), averaged over the size of its bends from a thousandth of `bend` to
  /// thrice it. Of the parameters and states it counts what fit::Fit::occam does, less the log of the
  /// precision believed.
  [[nodiscard]] double cost(double bend) const;

 private:
  struct Event {
    Eigen::MatrixXd slopes;  ///< by z and by the state
    Eigen::VectorXd residuals, precision, input;
  };
  [[nodiscard]] Eigen::Index states(const Event& e) const { return e.precision.size(); }
  Eigen::VectorXd precision_, z_;
  std::vector<Event> events_;
};

}  // namespace swingbank::validate::fit::fitting
