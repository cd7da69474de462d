#pragma once
// How a hypothesis is judged: fitted to all events, then by what it predicts for events left out of the fit.
#include <string>
#include <vector>

#include "validate/fit/fit.hpp"
#include "validate/fit/passed_noise.hpp"
#include "validate/hypothesis/hypothesis.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::hypothesis {

/// What a left-out event says of an effect, by the model fitted to the other events with and without it.
struct HeldOut {
  std::string record;
  double before = 0, after = 0;  ///< chi2 per value
  /// By how much the cost of the fit grows for each value when this event joins it. This is the event's chi2,
  /// less what the other events leave open of the parameters.
  double cost_before = 0, cost_after = 0;
  int values = 0;  ///< numbers compared
  /// What the effect takes off the cost of the whole event; negative where the effect costs.
  [[nodiscard]] double saves() const { return (cost_before - cost_after) * values; }
};

/// One hypothesis, fitted and judged.
struct Judgement {
  Hypothesis hypothesis;
  fit::Fit fit;                   ///< to all events
  double gain = 0;                ///< criterion(base) - criterion(with it): evidence in its favour
  double size = 0;                ///< what it adds to the answer: norm of the change / noise, per sqrt(value)
  std::vector<HeldOut> held_out;  ///< empty where judging was not worth it
  bool fitted = true;             ///< false: it gave no hope; `fit` is without it
  /// Of one that was identified and not fitted: chi2 that it leaves more than the best one.
  double behind = 0;
  /// Of a control that was identified: the effect of the machine or of an instrument beside which it leaves
  /// least, and by how much that is less than what the best control leaves alone. Empty: none is worth it.
  std::string companion = {};
  double companion_gain = 0;
  bool accepted = false;
  std::string why_not;  ///< empty where accepted
};

/// Parameters of the plant that a refit may move, then the hypothesis's own parameters.
std::vector<fit::FreeParameter> free_of(const Hypothesis& h, double spread);

/// Events to judge on, and what is known of them without any hypothesis.
struct Trial {
  const event::WhitenedEvents& events;
  double spread;                                    ///< believed of the model's parameters
  double adequate;                                  ///< chi2 per value up to which nothing but noise is left
  double evidence = thresholds::evidence.accepted;  ///< from which a hypothesis is accepted
  /// Noise of the voltage that the base passes into its answer: to pass less of it is no evidence. Null: this
  /// noise is not considered.
  const fit::PassedNoise* passed = nullptr;
};

/// Predicts each event by the structure fitted to the other events. Empty `free` means the plant's own
/// parameters.
std::vector<HeldOut> hold_out(const Trial& trial, const sim::plant::PlantUnderTest& tested,
                              const std::vector<fit::FreeParameter>& free, const fit::Fit& whole);
/// Says which left-out event speaks against an effect of this evidence, and how. Empty if none does.
/// `adequate` is that of Trial.
std::string objection(const std::vector<HeldOut>& held_out, double evidence, double adequate);
/// Does nothing if `j` was not fitted. Otherwise finishes its fit and accepts it if its evidence is strong,
/// every left-out event is predicted better than by the base, and nothing but noise is left. If not, says why
/// not.
void judge(const Trial& trial, const fit::Fit& base, const std::vector<HeldOut>& held_out_base, Judgement& j);

}  // namespace swingbank::validate::hypothesis
