#pragma once
// Which torque and which field voltage the records ask for, whatever made them: free in time beside the model
// as it was submitted, with its parameters, each event's start and its switching times. With these inputs
// free the machine's equations hold whatever is missing in its controls, so that the model is not bent to
// mimic what it lacks, and a few Gauss-Newton steps from the submitted values arrive. Which of them are
// needed the evidence tells.
#include <Eigen/Dense>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::reduced {

/// Moments at which the inputs of an event are free, straight lines between them. Behind the first switching
/// they may jump at each further one; there two moments lie a nanosecond apart.
struct Knots {
  std::vector<double> t;           ///< [s]
  std::vector<std::size_t> jumps;  ///< the first of each such pair
};

/// Whitened residuals of one event (model - measured) and their slopes about the point of an Inference:
/// [value][number]. Numbers of the plant are on the axes of a fit (fit/axis.hpp), the state's in its units
/// (fit/states.hpp), inputs in pu.
struct EventSlopes {
  Knots knots;
  Eigen::MatrixXd plant, state, torque, field;
  Eigen::VectorXd residual;
  Eigen::VectorXd state_at;  ///< where the state stands, in its units
};

/// Which inputs are free.
struct Inputs {
  bool torque = false, field = false;
};

struct Inference {
  Inputs inputs;
  sim::plant::Plant plant;  ///< with the values that were found
  std::vector<fit::FreeParameter> free;
  Eigen::VectorXd offset;                 ///< of the free parameters from what is believed, on their axes
  std::vector<event::EventState> states;  ///< with both inputs
  std::vector<EventSlopes> events;
  event::NoiseModel noise;
  double chi2 = 0;
  /// -2 log of the evidence by Laplace's approximation, up to what all inferences of these events share: what
  /// is free pays for what the records know of it beyond what is believed.
  double criterion = 0;
  int values = 0, steps = 0;
  [[nodiscard]] double misfit() const { return chi2 / values; }
};

/// How an input moves by itself: a random walk [pu^2/s]. A field voltage may run from one ceiling to the
/// other within a second, a turbine moves by a tenth of its rating in that time.
inline constexpr double kFieldWalk = 1.0, kTorqueWalk = 0.01;
/// Square root of the precision with which one knot is believed to follow the one before [1/pu].
Eigen::VectorXd walk_weights(const Knots& knots, event::InputKind kind);

/// How far each number of an event's state is believed to be off, in its units: an instant by its
/// uncertainty.
std::vector<double> own_beliefs(const event::FitEvent& event);

/// `steps`: Gauss-Newton steps at most. Throws InputError where the model as submitted cannot be run.
Inference infer(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
                const std::vector<fit::FreeParameter>& free, Inputs inputs, int threads, int steps = 5);
/// The same from another plant and with inputs that are given, which stand as they are.
Inference infer_beside(const sim::plant::PlantUnderTest& tested, const sim::plant::Plant& plant,
                       const event::WhitenedEvents& events, const std::vector<fit::FreeParameter>& free,
                       std::vector<event::EventState> states, int threads, int steps = 5);

}  // namespace swingbank::validate::reduced
