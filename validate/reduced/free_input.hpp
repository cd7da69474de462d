#pragma once
// A torque or a field voltage that is added to a model as a free function of time. If a free torque explains
// the records, a mechanical effect is missing. If a free field voltage explains them, an excitation effect is
// missing. The input's time series is reported, and user-defined models are fitted to it by regression.
#include <memory>

#include "validate/reduced/infer.hpp"

namespace swingbank::validate::reduced {

/// An inferred input with its evidence.
struct FreeInput {
  event::InputKind kind = event::InputKind::none;  ///< torque or field voltage
  /// Fit of the plant with the input; `parameters` is empty. The events' states contain the input. `failed`
  /// is set if the plant cannot be simulated.
  fit::Fit fit;
  std::vector<Eigen::VectorXd> deviation;  ///< posterior standard deviation of the input [event][knot] [pu]
  /// 2 ln(Bayes factor) over the model without the input, by Laplace's approximation, at the most probable
  /// intensity of the input's random walk. Noise alone gave -3 to 6 in six cases.
  double evidence = 0;
  std::shared_ptr<const Inference> inference;  ///< inference at the prior intensity

  /// Reduced chi-square; infinite if the plant cannot be simulated.
  [[nodiscard]] double reduced_chi2() const;
  /// Returns the inferred input of an event [pu].
  [[nodiscard]] const playin::PiecewiseLinear& of(std::size_t event) const {
    return fit.events[event].state.input(kind);
  }
};

/// Infers the input. `without`: the fit of the tested plant without the input. The inference begins at this
/// fit if its reduced chi-square is below thresholds::noise.measurable. Otherwise the fitted parameters are
/// biased, and the inference begins at the submitted values.
FreeInput free_input(event::InputKind kind, const sim::plant::PlantUnderTest& tested,
                     const noise::WhitenedEvents& events, const std::vector<fit::FreeParameter>& free,
                     const fit::Fit& without, int threads);

}  // namespace swingbank::validate::reduced
