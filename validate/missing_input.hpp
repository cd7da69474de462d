#pragma once
// The input that closes the gap: a torque or a field voltage, free in time, that makes the present structure
// answer as measured. The side is told by which of the two can do it. The input's course is the evidence and,
// where no known effect explains it, the material for a law.
#include "validate/fit.hpp"

namespace swingbank::validate {

/// The input of each event: straight pieces between knots, with a penalty on their bends.
struct MissingInput {
  InputKind kind = InputKind::torque;
  Fit fit;  ///< the plant refitted with the input; the events' states carry `input`
  [[nodiscard]] double misfit() const { return fit.misfit(); }
  /// What the input explains of the chi2 that `without` leaves, less twice the number of its knots (Akaike
  /// 1974).
  [[nodiscard]] double explains(const Fit& without) const;
  [[nodiscard]] const PiecewiseLinear& of(std::size_t event) const { return fit.events[event].state.input; }
};

/// Infers the input while the plant's parameters are free within `spread`.
MissingInput infer_input(InputKind kind, const sim::Plant& plant, const sim::Conventions& conventions,
                         const std::vector<FitEvent>& events, double spread, const FitOptions& start);

}  // namespace swingbank::validate
