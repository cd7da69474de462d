#pragma once
// The reduced plant. Near an inference the residuals of an event are linear in the plant's parameters, the
// event's state, torque and field voltage. A QR decomposition eliminates the event's state. What remains is
// the cost of any time series u(t) of one input, whichever block makes it, minimised over the plant's
// parameters d:
//   |r + T d + L g u|^2 + |(offset + d) / spread|^2
// One parameter, d_g, also scales the effect of the input: a machine's state follows it at the rate 1/T'do
// (field voltage) or 1/2H (torque). It stays explicit: g = exp(exponent d_g).
#include <Eigen/SparseCore>

#include "validate/playin/open_loop.hpp"
#include "validate/reduced/infer.hpp"

namespace swingbank::validate::reduced {

/// Both inputs of all events.
class Reduction {
 public:
  Reduction(Inference inference, const event::WhitenedEvents& events, const sim::Conventions& conventions);

  [[nodiscard]] const Inference& inference() const { return inference_; }
  [[nodiscard]] const sim::Conventions& conventions() const { return conventions_; }
  /// One event.
  struct Event {
    playin::OpenLoop loop;  ///< of the plant's controls
    Eigen::SparseMatrix<double, Eigen::RowMajor>
        over_hats;  ///< mean over each knot's hat function: [knot][time point]
    /// Rows of [plant | torque | field | residual without either input].
    Eigen::MatrixXd triangle;
    Knots knots;
  };
  [[nodiscard]] const std::vector<Event>& events() const { return events_; }
  /// How many knots all events have.
  [[nodiscard]] Eigen::Index knots() const { return knots_; }
  /// Between two samples [s].
  [[nodiscard]] double step() const { return step_; }
  /// An input as inferred, at the knots of all events.
  [[nodiscard]] const Eigen::VectorXd& series(event::InputKind kind) const {
    return kind == event::InputKind::torque ? torque_ : field_;
  }
  /// The plant parameter that scales an input, and its exponent.
  struct Gain {
    Eigen::Index number = -1;  ///< -1: none is
    double exponent = 0;
  };
  [[nodiscard]] Gain gain(event::InputKind kind) const {
    return kind == event::InputKind::torque ? torque_gain_ : field_gain_;
  }

 private:
  [[nodiscard]] Gain find_gain(const event::WhitenedEvents& events, event::InputKind kind) const;
  Inference inference_;
  sim::Conventions conventions_;
  std::vector<Event> events_;
  Eigen::Index knots_ = 0;
  double step_ = 0;
  Eigen::VectorXd torque_, field_;
  Gain torque_gain_, field_gain_;
};

/// Cost of one input's time series.
class ReducedPlant {
 public:
  /// `other`: time series of the other input at the knots of all events; null: it stays free. `held` marks
  /// plant parameters that are fixed because their blocks are absent; empty: none.
  ReducedPlant(const Reduction& reduction, event::InputKind kind, const Eigen::VectorXd* other,
               const std::vector<char>& held = {});

  /// Cost of each time series [knot of all events][series], each with its change of the gain's parameter.
  [[nodiscard]] Eigen::VectorXd costs(const Eigen::MatrixXd& series, const Eigen::VectorXd& gains) const;
  /// Half the gradient and the Gauss-Newton Hessian of the cost of one time series, by the gain's parameter
  /// and by those whose Jacobian `slopes` [knot][parameter] is; the other plant parameters are eliminated.
  struct Quadratic {
    Eigen::MatrixXd curvature;
    Eigen::VectorXd gradient;
  };
  [[nodiscard]] Quadratic quadratic(const Eigen::VectorXd& series, double gain,
                                    const Eigen::MatrixXd& slopes) const;
  /// Changes of the plant parameters that minimise the cost of a time series.
  [[nodiscard]] Eigen::VectorXd plant_of(const Eigen::VectorXd& series, double gain) const;
  [[nodiscard]] Reduction::Gain gain() const { return gain_; }

 private:
  struct Event {
    Eigen::VectorXd r, by_gain;
    Eigen::MatrixXd T, L;  ///< by the eliminated parameters, by the time series
  };
  [[nodiscard]] double factor(double gain) const { return std::exp(gain_.exponent * gain); }

  Reduction::Gain gain_;
  std::vector<Eigen::Index> free_;  ///< eliminated parameters
  Eigen::Index numbers_;
  std::vector<Event> events_;
  Eigen::MatrixXd inverse_;  ///< of their Hessian
  Eigen::VectorXd first_;    ///< half the gradient of their prior
  double prior_cost_ = 0;    ///< of the present values
  double gain_precision_ = 0, gain_offset_ = 0;
};

}  // namespace swingbank::validate::reduced
