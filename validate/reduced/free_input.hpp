#pragma once
// A torque or a field voltage that is free in time beside a model. Which of the two explains the records says
// on which side something is missing; its time series is shown, and laws are looked for in it.
#include <memory>

#include "validate/reduced/infer.hpp"

namespace swingbank::validate::reduced {

struct FreeInput {
  event::InputKind kind = event::InputKind::none;
  /// The plant with the input, which the events' states hold; without parameters. Failed: it cannot be run.
  fit::Fit fit;
  std::vector<Eigen::VectorXd> deviation;  ///< posterior standard deviation of the input [event][knot] [pu]
  /// Evidence over the model without it: difference of -2 log by Laplace's approximation, with the most
  /// probable intensity of the input's random walk. Noise alone gave -3 to 6 in six cases.
  double evidence = 0;
  std::shared_ptr<const Inference> inference;  ///< with the prior intensity

  /// chi2 per value; infinite where the plant cannot be run.
  [[nodiscard]] double misfit() const;
  [[nodiscard]] const playin::PiecewiseLinear& of(std::size_t event) const {
    return fit.events[event].state.input(kind);
  }
};

/// Infers the input. `without`: the fit of the tested plant without it. The inference begins there, or at the
/// submitted values where `without` fits badly and its parameters are biased.
FreeInput free_input(event::InputKind kind, const sim::plant::PlantUnderTest& tested,
                     const event::WhitenedEvents& events, const std::vector<fit::FreeParameter>& free,
                     const fit::Fit& without, int threads);

}  // namespace swingbank::validate::reduced
