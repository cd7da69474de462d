#pragma once
// Judgement of a hypothesis: fit to all events, then hold-out of each event in turn (cross-validation).
#include <string>
#include <utility>
#include <vector>

#include "validate/fit/fit.hpp"
#include "validate/hypothesis/hypothesis.hpp"
#include "validate/noise/noise_transfer.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::hypothesis {

/// Result of one held-out event. The model was fitted to the other events, with and without an effect.
struct HeldOut {
  std::string record;            ///< name of the record
  double before = 0, after = 0;  ///< reduced chi-square without and with the effect
  /// Increase of the fit's cost, per value of this event, when the event joins the fit. It is the event's
  /// chi2 without the part due to parameters that the other events do not determine.
  double cost_before = 0, cost_after = 0;  ///< cost per value without and with the effect
  int values = 0;                          ///< number of compared values
  /// Returns the effect's reduction of the cost of the whole event; negative if the cost rises.
  [[nodiscard]] double saves() const { return (cost_before - cost_after) * values; }
};

/// Returns the means of HeldOut::before and HeldOut::after; 0 without held-out events.
std::pair<double, double> mean_reduced_chi2(const std::vector<HeldOut>& held_out);

/// A hypothesis with its fit and verdict.
struct Judgement {
  Hypothesis hypothesis;  ///< judged hypothesis
  fit::Fit fit;           ///< fit to all events
  double gain = 0;        ///< 2 ln(Bayes factor): fit::criterion of the base model minus that of `fit`
  double size = 0;        ///< square root of the hypothesis's reduction of chi2 [noise standard deviations]
  std::vector<HeldOut> held_out;  ///< empty: not judged
  bool fitted = true;             ///< whether it was fitted; if not, `fit` is that of the base model
  /// For a hypothesis that was identified but not fitted: its cost (chi2 with priors) minus that of the best
  /// fitted hypothesis.
  double behind = 0;
  /// For an identified control: the effect of the machine or of an instrument with which its cost is lowest.
  /// Empty: no effect brings this cost far enough below that of the best single control.
  std::string companion = {};
  double companion_gain = 0;  ///< cost of the best single control minus that with the companion
  bool accepted = false;      ///< whether all criteria of acceptance are met
  std::string why_not;        ///< reason for rejection; empty if accepted
};

/// Returns the plant parameters that a refit may change, then the hypothesis's own parameters.
std::vector<fit::FreeParameter> free_of(const Hypothesis& h, double prior_sd);

/// Events of the judgement, and the limits of acceptance.
struct Trial {
  const noise::WhitenedEvents& events;  ///< events with their noise model
  double prior_sd;                      ///< prior standard deviation of the model's parameters
  double adequate;                      ///< reduced chi-square up to which the residual counts as noise
  double evidence = thresholds::evidence.accepted;  ///< minimum evidence of an accepted hypothesis
  /// Voltage noise that the base model transfers: a reduction of chi2 due to a lower transfer is no evidence.
  /// Null: not considered.
  const noise::NoiseTransfer* noise_transfer = nullptr;
};

/// Predicts each event with the structure fitted to the other events. Fills HeldOut::after and cost_after.
/// `whole`: fit to all events. If `free` is empty, the plant's own parameters are free.
std::vector<HeldOut> hold_out(const Trial& trial, const sim::plant::PlantUnderTest& tested,
                              const std::vector<fit::FreeParameter>& free, const fit::Fit& whole);
/// Returns the reason why a held-out event contradicts an effect of this evidence; empty if none does.
/// `adequate` is Trial::adequate.
std::string objection(const std::vector<HeldOut>& held_out, double evidence, double adequate);
/// Completes the fit of `j` and accepts the hypothesis if three conditions are met: its evidence is at least
/// Trial::evidence, no held-out event contradicts it (objection()), and the reduced chi-square of the fit is
/// at most Trial::adequate. Otherwise sets `why_not`. `held_out_base`: results of hold_out() for the base
/// model. Has no effect on a hypothesis that was not fitted.
void judge(const Trial& trial, const fit::Fit& base, const std::vector<HeldOut>& held_out_base, Judgement& j);

}  // namespace swingbank::validate::hypothesis
