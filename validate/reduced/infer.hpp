#pragma once
// Inference of the torque and the field voltage that the records imply: time series estimated together with
// the parameters of the submitted model and with the start and switching times of each event. The machine's
// equations hold whatever its controls lack, so a few Gauss-Newton steps from the submitted values suffice.
// The evidence decides which of the two inputs is needed.
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::reduced {

/// Knots of an event's inputs, which are linear between them. An input may jump at each switching time after
/// the first; two knots lie a nanosecond apart there.
struct Knots {
  std::vector<double> t;           ///< [s]
  std::vector<std::size_t> jumps;  ///< the first of each such pair
};

/// Whitened residuals of one event (model - measured) and their Jacobians at the point of an Inference:
/// [value][parameter]. Plant parameters are on the axes of a fit (fit/axis.hpp), the event's state in its
/// units (fit/states.hpp), inputs in pu.
struct EventSlopes {
  Knots knots;
  Eigen::MatrixXd plant, state, torque, field;  ///< without columns: of an input that is not asked for
  Eigen::MatrixXd changes;                      ///< of add_changes
  /// Posterior standard deviations of the inputs at the knots [pu]; of infer_smooth alone.
  Eigen::VectorXd torque_deviation, field_deviation;
  Eigen::VectorXd residual;
  Eigen::VectorXd state_at;  ///< estimate of the state, in its units
};

/// Which inputs are free.
struct Inputs {
  bool torque = false, field = false;
};

struct Inference {
  Inputs inputs;
  /// The submitted plant with the estimated values, and the plant that was simulated. They differ where that
  /// one has a block more.
  sim::plant::Plant base, plant;
  std::vector<fit::FreeParameter> free;   ///< of `base`
  Eigen::VectorXd offset;                 ///< of the free parameters from their prior mean, on their axes
  std::vector<event::EventState> states;  ///< with both inputs
  std::vector<EventSlopes> events;
  event::NoiseModel noise;
  double chi2 = 0;
  /// -2 log of the evidence by Laplace's approximation, up to a constant that all inferences of
  /// these events share.
  double criterion = 0;
  double intensity = 1.0;  ///< of the inputs' random walk, as a multiple of the prior's
  int values = 0, steps = 0;
  [[nodiscard]] double misfit() const { return chi2 / values; }
};

/// A change of the simulated plant that its parameters do not make: a parameter at its neutral value, an
/// instrument's error.
struct Change {
  sim::plant::Plant from, to;
};
/// Gives an inference a column for each change: residuals with `to` less those with `from`, in the
/// inference's states. Zero where one of them cannot be run.
void add_changes(Inference& inference, const event::WhitenedEvents& events,
                 const sim::Conventions& conventions, std::span<const Change> changes, int threads);

/// Prior of an input: the variance of a random walk [pu^2/s]. A field voltage may run from one ceiling to the
/// other within a second; a turbine moves by a tenth of its rating in that time.
inline constexpr double kFieldWalk = 1.0, kTorqueWalk = 0.01;
/// Square root of the prior precision of each knot given the one before [1/pu].
Eigen::VectorXd walk_weights(const Knots& knots, event::InputKind kind);

/// Prior standard deviation of each number of an event's state, in its units: of a switching time its
/// uncertainty.
std::vector<double> own_priors(const event::FitEvent& event);
/// Keeps the switching times of an event's state within their uncertainties.
void keep_in_range(const event::FitEvent& event, Eigen::VectorXd& state);

inline constexpr int kInferenceSteps = 5;  ///< Gauss-Newton steps of an inference, at most
/// Begins at the submitted values. Throws InputError where the model as submitted cannot be run.
Inference infer(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
                const std::vector<fit::FreeParameter>& free, Inputs inputs, int threads,
                int steps = kInferenceSteps);

/// Two inferences, of which the second goes on from the first: with the prior intensity of the inputs' random
/// walk, and with the most probable one, which is small where the records ask for no input.
struct SmoothInference {
  Inference prior, smooth;
};
/// `from`: a fit of the tested plant without inputs, whose residuals are nearly linear in them; the first
/// inference is then its linear point. Null: both begin at the submitted values. Throws as infer().
SmoothInference infer_smooth(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
                             const std::vector<fit::FreeParameter>& free, Inputs inputs, int threads,
                             const fit::Fit* from);
/// The same about `plant` as it stands, which is the tested plant or has another block in addition or in its
/// place, in these states, with Jacobians by the inputs asked for, which are zero. Throws InputError where it
/// cannot be run.
Inference linear_about(const sim::plant::Plant& plant, const sim::plant::PlantUnderTest& tested,
                       const event::WhitenedEvents& events, const std::vector<fit::FreeParameter>& free,
                       const std::vector<event::EventState>& states, Inputs inputs, int threads);

}  // namespace swingbank::validate::reduced
