#pragma once
// The input that closes the gap: a torque, or a field voltage, free in time, that makes the present structure
// answer as measured. Which of the two can, tells the side; its course is the evidence and, where no known
// effect explains it, the material for a law.
#include "validate/fit.hpp"

namespace swingbank::validate {

/// Straight pieces between knots, with a penalty on their bends; one per event.
struct MissingInput {
  InputKind kind = InputKind::torque;
  Fit fit;  ///< the plant refitted with it; events' states carry `input`
  [[nodiscard]] double misfit() const { return fit.misfit(); }
  /// What it explains of the chi2 that `without` leaves, less what as many free numbers would do of noise,
  /// twice (Akaike 1974).
  [[nodiscard]] double explains(const Fit& without) const;
  [[nodiscard]] const PiecewiseLinear& of(std::size_t event) const { return fit.events[event].state.input; }
};

/// Infers it, the plant's parameters free within `spread`.
MissingInput infer_input(InputKind kind, const sim::Plant& plant, const sim::Conventions& conventions,
                         const std::vector<FitEvent>& events, double spread, const FitOptions& start);

}  // namespace swingbank::validate
