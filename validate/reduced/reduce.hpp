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

/// Of the inputs that an inference has, in all events.
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
    /// Rows of [plant | changes | torque | field | residual without either input], once the event's state is
    /// eliminated.
    Eigen::MatrixXd triangle;
    /// The same of [state | plant | changes | torque | field | residual]: what the state then is.
    Eigen::MatrixXd by_state;
    Knots knots;
  };
  [[nodiscard]] const std::vector<Event>& events() const { return events_; }
  /// How many changes beside the plant's parameters (add_changes).
  [[nodiscard]] Eigen::Index changes() const { return inference_.events.front().changes.cols(); }
  /// How many knots all events have.
  [[nodiscard]] Eigen::Index knots() const { return knots_; }
  /// Between two samples [s].
  [[nodiscard]] double step() const { return step_; }
  /// What the controls of plants with the same blocks make of the signals of the simulated plant, at all
  /// knots: [knot][plant].
  [[nodiscard]] Eigen::MatrixXd responses(event::InputKind kind,
                                          const std::vector<sim::plant::Plant>& plants) const;
  /// What the simulated plant has of an input beside the controls of the submitted plant, at all knots: as
  /// inferred, or what its other block makes.
  [[nodiscard]] const Eigen::VectorXd& series(event::InputKind kind) const {
    return kind == event::InputKind::torque ? torque_ : field_;
  }
  /// The events' states that minimise the cost at these changes of the plant's parameters, with this time
  /// series of the only input, in the states' units.
  [[nodiscard]] std::vector<Eigen::VectorXd> states_at(const event::WhitenedEvents& events,
                                                       event::InputKind kind, const Eigen::VectorXd& plant,
                                                       const Eigen::VectorXd& series) const;
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
  /// The other input stays free where the reduction has it. `held` marks plant parameters that are fixed
  /// because their blocks are absent; empty: none. Of the changes only those of `freed` are made.
  ReducedPlant(const Reduction& reduction, event::InputKind kind, const std::vector<char>& held = {},
               const std::vector<Eigen::Index>& freed = {});

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
  /// Changes of the plant parameters that minimise the cost of a time series; without those of add_changes.
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
