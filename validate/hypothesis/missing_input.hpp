#pragma once
// The input that closes the gap: a torque or a field voltage, free in time, that makes the present structure
// answer as measured. The side is told by which of the two can do it. The input's course is the evidence and,
// where no known effect explains it, the material for a law.
#include "validate/fit/fit.hpp"

namespace swingbank::validate::hypothesis {

/// The input of each event: straight pieces between knots, with a penalty on their bends.
struct MissingInput {
  fit::InputKind kind = fit::InputKind::torque;
  fit::Fit fit;  ///< the plant refitted with the input; the events' states carry `input`
  [[nodiscard]] double misfit() const { return fit.misfit(); }
  /// What the input explains of the chi2 that `without` leaves, less twice the number of its knots (Akaike
  /// 1974).
  [[nodiscard]] double explains(const fit::Fit& without) const;
  /// Evidence of the input over `without` by Laplace's approximation, as effects have it (fit::criterion):
  /// its knots pay for what the records know of them beyond what is believed of bends.
  [[nodiscard]] double evidence(const fit::Fit& without) const;
  [[nodiscard]] const playin::PiecewiseLinear& of(std::size_t event) const {
    return fit.events[event].state.input(kind);
  }
};

/// Infers the input while the plant's parameters are free within `spread`. It goes on from the inputs of
/// `start` where these have the same knots.
MissingInput infer_input(fit::InputKind kind, const sim::plant::PlantUnderTest& tested,
                         const event::WhitenedEvents& events, double spread, const fit::FitOptions& start);

}  // namespace swingbank::validate::hypothesis
