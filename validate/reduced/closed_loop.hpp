#pragma once
// Linearised residuals of a whole plant, for changes that act anywhere in it: parameters at their null
// values, effects of the machine, of instruments and of converters. A trial (a candidate for such a change)
// is simulated with the whole plant in closed loop. The plant's other parameters and the events' states stay
// linear.
#include "validate/reduced/reduced_cost.hpp"

namespace swingbank::validate::reduced {

/// Linearised events of a plant, with their states eliminated.
class ClosedLoop {
 public:
  /// Takes an inference without free inputs. `events` must outlive this object.
  ClosedLoop(Inference inference, const noise::WhitenedEvents& events);
  /// One linearised event.
  struct Event {
    Eigen::MatrixXd
        basis;  ///< orthonormal basis of the state's columns: [value, state variable][state variable]
    Eigen::MatrixXd plant;     ///< Jacobian with respect to the plant's parameters, orthogonal to the basis
    Eigen::VectorXd residual;  ///< residual, orthogonal to the basis
  };
  /// Returns the linearised events.
  [[nodiscard]] const std::vector<Event>& events() const { return linear_; }
  /// Returns the inference.
  [[nodiscard]] const Inference& inference() const { return inference_; }
  /// Sampling interval [s].
  [[nodiscard]] double step() const { return events_.front().record.step(); }
  /// Returns the change of the whitened residuals, orthogonal to the bases, for plants that differ in
  /// parameter values only: [value and state variable of all events][plant]. It is NaN for a plant that
  /// cannot be simulated.
  [[nodiscard]] Eigen::MatrixXd responses(const std::vector<sim::plant::Plant>& plants,
                                          const sim::Conventions& conventions) const;

 private:
  Inference inference_;
  const noise::WhitenedEvents& events_;
  std::vector<Event> linear_;
  Eigen::Index rows_ = 0;
};

/// Cost of a trial in closed loop: its responses are changes of the residuals [row of all events].
class ClosedLoopCost : public ReducedCost {
 public:
  /// `held`: see ReducedPlant. `plant` must outlive this object. `conventions` are those of the trial.
  ClosedLoopCost(const ClosedLoop& plant, const sim::Conventions& conventions, const std::vector<char>& held);

  [[nodiscard]] const Inference& inference() const override { return plant_.inference(); }
  [[nodiscard]] double step() const override { return plant_.step(); }
  [[nodiscard]] Eigen::MatrixXd responses(const std::vector<sim::plant::Plant>& plants) const override {
    return plant_.responses(plants, conventions_);
  }
  [[nodiscard]] bool acts(const Eigen::VectorXd& response) const override;

 private:
  const ClosedLoop& plant_;
  sim::Conventions conventions_;
};

}  // namespace swingbank::validate::reduced
