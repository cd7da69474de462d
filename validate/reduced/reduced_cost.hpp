#pragma once
// Cost of a change of the plant near a point at which the plant's residuals were linearised, with all other
// unknowns eliminated. The response u of a trial (candidate change) is the change that its block causes. All
// other unknowns d are linear:
//   |r + T d + L g u|^2 + |(offset + d) / prior_sd|^2
#include "validate/reduced/infer.hpp"

namespace swingbank::validate::reduced {

/// Cost of a response u, minimised over the changes d of all plant parameters except the gain parameter:
///
/// \f[ J(u) = \min_d |r + T d + L g u|^2 + |(o + d) / \sigma|^2 \f]
///
/// r: residuals; T, L: their derivatives with respect to parameters and response; g: factor due to the gain
/// parameter (gain()); o: offsets of the parameters from their prior means; \f$ \sigma \f$: prior standard
/// deviations. The states of the events are eliminated from r, T and L.
class ReducedCost {
 public:
  virtual ~ReducedCost() = default;
  /// Returns the point of the linearisation.
  [[nodiscard]] virtual const Inference& inference() const = 0;
  /// Sampling interval [s].
  [[nodiscard]] virtual double step() const = 0;
  /// Returns the responses of plants with equal blocks: [row of all events][plant]. A column is not finite if
  /// the plant cannot be simulated.
  [[nodiscard]] virtual Eigen::MatrixXd responses(const std::vector<sim::plant::Plant>& plants) const = 0;
  /// Returns whether a response [row of all events] exceeds the numerical error of a zero response.
  [[nodiscard]] virtual bool acts(const Eigen::VectorXd& response) const = 0;

  /// Returns the cost of each response. `responses`: [row of all events][response]; `gains`: change of the
  /// gain's parameter for each response.
  [[nodiscard]] Eigen::VectorXd costs(const Eigen::MatrixXd& responses, const Eigen::VectorXd& gains) const;
  /// Half the gradient and half the Gauss-Newton Hessian of the cost of one response. The variables are the
  /// gain's parameter and the parameters of `jacobian` [row][parameter]; all other plant parameters are
  /// eliminated.
  struct Quadratic {
    Eigen::MatrixXd curvature;  ///< half the Hessian
    Eigen::VectorXd gradient;   ///< half the gradient
  };
  /// Computes the quadratic model of the cost of one response. `gain`: change of the gain's parameter.
  [[nodiscard]] Quadratic quadratic(const Eigen::VectorXd& response, double gain,
                                    const Eigen::MatrixXd& jacobian) const;
  /// Returns the changes of the plant parameters that minimise the cost of a response, without those of
  /// add_changes().
  [[nodiscard]] Eigen::VectorXd plant_of(const Eigen::VectorXd& response, double gain) const;
  /// The plant parameter that scales the response, and its exponent.
  struct Gain {
    Eigen::Index number = -1;  ///< index of the parameter; -1: none
    double exponent = 0;       ///< exponent of the parameter in the response
  };
  /// Returns the parameter that scales the response, and its exponent.
  [[nodiscard]] Gain gain() const { return gain_; }

 protected:
  /// Terms of one event.
  struct Event {
    Eigen::VectorXd r,
        by_gain;  ///< residual without any response; its derivative with respect to the gain's parameter
    Eigen::MatrixXd T;  ///< Jacobian with respect to the eliminated parameters
    Eigen::MatrixXd
        L;  ///< Jacobian with respect to the response; empty: the response is a change of the residual
  };
  /// Sets the eliminated parameters and their priors: those of `at` that are not `held`, then `freed`.
  void eliminate(const Inference& at, Gain gain, const std::vector<char>& held,
                 const std::vector<Eigen::Index>& freed = {});
  /// Returns the indices of the eliminated parameters among the columns [plant | changes].
  [[nodiscard]] const std::vector<Eigen::Index>& eliminated() const { return free_; }
  /// Adds an event whose T has the eliminated parameters' columns.
  void add(Event event) { events_.push_back(std::move(event)); }
  /// Computes the inverse Hessian after the last add().
  void finish();

 private:
  [[nodiscard]] double factor(double gain) const;
  /// Number of rows of a response that belong to an event.
  static Eigen::Index rows(const Event& e);
  /// Returns the residuals that responses cause: [value][response].
  static Eigen::MatrixXd seen(const Event& e, const Eigen::MatrixXd& responses);

  Gain gain_;
  std::vector<Eigen::Index> free_;  ///< eliminated parameters
  Eigen::Index numbers_ = 0;
  std::vector<Event> events_;
  Eigen::VectorXd precision_;  ///< prior precision of the eliminated parameters
  Eigen::MatrixXd inverse_;    ///< inverse Hessian of the eliminated parameters
  Eigen::VectorXd first_;      ///< half the gradient of the prior of these parameters
  double prior_cost_ = 0;      ///< prior cost at the present values
  double gain_precision_ = 0, gain_offset_ = 0;
};

/// Marks parameters of the submitted plant whose blocks are absent from `plant`.
std::vector<char> mark_absent(const Inference& inference, const sim::plant::Plant& plant);

}  // namespace swingbank::validate::reduced
