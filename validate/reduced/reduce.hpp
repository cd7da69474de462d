#pragma once
// The reduced plant: the cost of an input's time series with all other unknowns eliminated. Near an inference
// the residuals of an event are linear in the plant's parameters, the event's state, torque and field
// voltage. A QR decomposition eliminates the event's state. The remaining cost of any time series u(t) of one
// input, whichever block generates it, is minimised over the changes d of the plant's parameters:
//   |r + T d + L g u|^2 + |(offset + d) / prior_sd|^2
// r: residuals; T, L: their derivatives with respect to parameters and input; offset: parameters minus prior
// means. One parameter, d_g, also scales the influence of the input, because a machine's state follows the
// input at the rate 1/T'do (field voltage) or 1/2H (torque). This factor stays explicit: g = exp(exponent
// d_g).
#include <Eigen/SparseCore>

#include "validate/playin/open_loop.hpp"
#include "validate/reduced/reduced_cost.hpp"

namespace swingbank::validate::reduced {

/// Reduction of all events for the inputs of an inference.
class Reduction {
 public:
  /// Reduces the events of `events` to the inputs and parameters of the inference.
  Reduction(Inference inference, const noise::WhitenedEvents& events, const sim::Conventions& conventions);

  /// Returns the inference that is reduced.
  [[nodiscard]] const Inference& inference() const { return inference_; }
  /// One reduced event.
  struct Event {
    playin::OpenLoop loop;  ///< open loop of the plant's controls
    /// Weights of the mean over each knot's hat function: [knot][time point].
    Eigen::SparseMatrix<double, Eigen::RowMajor> over_hats;
    /// Triangular factor with columns [plant | changes | torque | field | residual without either input],
    /// after elimination of the event's state.
    Eigen::MatrixXd triangle;
    /// Rows of the same factor with columns [state | plant | changes | torque | field | residual], which
    /// determine the state.
    Eigen::MatrixXd by_state;
    Knots knots;  ///< knots of the inputs
  };
  /// Returns the reduced events, in the order of the inference.
  [[nodiscard]] const std::vector<Event>& events() const { return events_; }
  /// Number of changes besides the plant's parameters (add_changes).
  [[nodiscard]] Eigen::Index changes() const { return inference_.events.front().changes.cols(); }
  /// Total number of knots of all events.
  [[nodiscard]] Eigen::Index knots() const { return knots_; }
  /// Sampling interval [s].
  [[nodiscard]] double step() const { return step_; }
  /// Returns the open-loop output of the controls of several plants with equal blocks, at all knots:
  /// [knot][plant]. The controls receive the signals of the simulated plant.
  [[nodiscard]] Eigen::MatrixXd responses(event::InputKind kind,
                                          const std::vector<sim::plant::Plant>& plants) const;
  /// Returns, at all knots, the part of an input that the submitted plant's controls do not produce. It is
  /// the inferred input, or the output of the simulated plant's additional block.
  [[nodiscard]] const Eigen::VectorXd& series(event::InputKind kind) const {
    return kind == event::InputKind::torque ? torque_ : field_;
  }
  /// Returns the events' states that minimise the cost, in the units of the search. `plant`: changes of the
  /// plant's parameters; `series`: time series of the input `kind`, the only free input.
  [[nodiscard]] std::vector<Eigen::VectorXd> states_at(const noise::WhitenedEvents& events,
                                                       event::InputKind kind, const Eigen::VectorXd& plant,
                                                       const Eigen::VectorXd& series) const;
  /// Returns the parameter that scales an input, and its exponent.
  [[nodiscard]] ReducedCost::Gain gain(event::InputKind kind) const {
    return kind == event::InputKind::torque ? torque_gain_ : field_gain_;
  }

 private:
  [[nodiscard]] ReducedCost::Gain find_gain(const noise::WhitenedEvents& events, event::InputKind kind) const;
  Inference inference_;
  sim::Conventions conventions_;
  std::vector<Event> events_;
  Eigen::Index knots_ = 0;
  double step_ = 0;
  Eigen::VectorXd torque_, field_;
  ReducedCost::Gain torque_gain_, field_gain_;
};

/// Cost of one input's time series u in a Reduction (reduced_cost.hpp), in open loop. A response is the time
/// series that a block adds to the output of the plant's own controls [knot of all events].
class ReducedPlant : public ReducedCost {
 public:
  /// The input that is not `kind` stays free if the reduction contains it. `held` marks plant parameters that
  /// are fixed because their blocks are absent; empty: none. Of the changes (add_changes()), only those with
  /// an index in `freed` are free. The reduction must outlive this object.
  ReducedPlant(const Reduction& reduction, event::InputKind kind, const std::vector<char>& held = {},
               const std::vector<Eigen::Index>& freed = {});

  [[nodiscard]] const Inference& inference() const override { return reduction_.inference(); }
  [[nodiscard]] double step() const override { return reduction_.step(); }
  [[nodiscard]] Eigen::MatrixXd responses(const std::vector<sim::plant::Plant>& plants) const override;
  [[nodiscard]] bool acts(const Eigen::VectorXd& response) const override { return !response.isZero(); }

 private:
  const Reduction& reduction_;
  event::InputKind kind_;
  Eigen::VectorXd without_;  ///< output of the submitted plant's own controls
};

}  // namespace swingbank::validate::reduced
