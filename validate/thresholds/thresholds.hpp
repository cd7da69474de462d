#pragma once
// The numbers that decide a verdict: limits of noise, evidence, prediction and adequacy. Each struct is a
// group of thresholds; `swingbank diagnose --thresholds` prints them all, with the limits of fit for purpose
// (acceptance.hpp). Numbers that only control the effort of a search (steps, starts, iterations) are defined
// with the search.
#include <string_view>

namespace swingbank::validate::thresholds {

/// A number that decides a verdict, with its name, unit and reason.
struct Threshold {
  std::string_view name;  ///< group.field
  double value;           ///< number that the verdict compares with [unit]
  std::string_view unit;  ///< unit of the value
  std::string_view why;   ///< the decision it controls, and its decision record (docs/decisions) or source
  /// Converts to the value.
  constexpr operator double() const { return value; }  // NOLINT: a threshold is used as its value
};

/// Thresholds of evidence, 2 ln(Bayes factor) by Laplace's approximation in units of chi2 (decision 41).
struct Evidence {
  /// Evidence from which diagnose accepts an effect [chi2].
  Threshold accepted{
      "evidence.accepted", 40, "chi2",
      "least evidence of an accepted effect; the best of about thirty wrong effects reached 20 "
      "in thirty development cases without a hidden effect (decisions 16 and 41)"};
  /// Additional evidence of a pair of effects over every single effect [chi2].
  Threshold second{
      "evidence.second", 80, "chi2",
      "least advantage of a pair over every accepted single effect, in evidence and in chi2, because "
      "the residual of the first effect or of the instruments resembles a second effect "
      "(decision 61)"};
  /// Largest gain in evidence that a longer fit is expected to bring [chi2].
  Threshold within_reach{"evidence.within_reach", 200, "chi2",
                         "largest gain that a long fit is expected to add to a short one; hypotheses whose "
                         "evidence is lower than the best by more than this are neither refined nor judged "
                         "(decision 61)"};
  /// Share of the leading hypothesis's evidence. If a better optimum of the base model reduces chi2 by more
  /// than this share, the diagnosis starts again [-].
  Threshold escape{
      "evidence.escape", 0.5, "share of the leading hypothesis's evidence",
      "if a better optimum of the base model reduces chi2 by more, the diagnosis starts again (decision 61)"};
  /// Largest excess in chi2 with which a completed fit still replaces a short fit [chi2].
  Threshold same_fit{
      "evidence.same_fit", 0.5, "chi2",
      "a complete fit replaces a short one (without standard errors), unless its chi2 is higher by more than "
      "this"};
};
inline constexpr Evidence evidence;  ///< the thresholds in use

/// Conversion of evidence to posterior probabilities (decision 41).
struct Posterior {
  /// Divisor that tempers the evidence before its conversion to a probability [chi2].
  Threshold scale{"posterior.scale", 6, "chi2",
                  "divisor of the evidence before the conversion to a probability, because fits end before "
                  "their optima and the noise model is incomplete; the likelihood of 21 earlier blind "
                  "cases is flat from 4 to 6 (decision 41)"};
  /// Total probability of the set of credible explanations [-].
  Threshold set{"posterior.set", 0.95, "probability", "total probability of the credible set (decision 41)"};
  /// Probability above which the verdict names the first explanation of the set [-].
  Threshold named{
      "posterior.named", 0.5, "probability",
      "least probability at which the verdict names the first explanation of the set (decision 41)"};
  /// Probability relative to the leading explanation below which a fit is not continued [-].
  Threshold negligible{"posterior.negligible", 1e-4, "probability relative to the leading one",
                       "hypotheses that cannot exceed this are not refined (decision 61)"};
};
inline constexpr Posterior posterior;  ///< the thresholds in use

/// Thresholds of the hold-out test of an effect on unseen events (decision 41).
struct HeldOut {
  /// Largest ratio of the costs with and without the effect on an unseen event [-].
  Threshold worse{
      "held_out.worse", 1.02, "ratio of costs",
      "largest ratio of the costs of a held-out event with and without the effect, unless the cost is "
      "within the limit of adequacy; allows for scatter of the refit (decision 41)"};
  /// Largest increase of the cost of an unseen event [chi2].
  Threshold costs{
      "held_out.costs", 20, "chi2",
      "largest increase of the cost of a held-out event by an effect, or costs_share of its evidence, "
      "whichever is larger; a component that is really missing does not increase it (decision 41)"};
  /// Largest increase of the cost of an unseen event, as a share of the effect's evidence [-].
  Threshold costs_share{"held_out.costs_share", 0.1, "share of the effect's evidence",
                        "see held_out.costs (decision 41)"};
  /// Cost per value up to which an unseen event is predicted [chi2 per value].
  Threshold predicts{"held_out.predicts", 1.25, "chi2 per value",
                     "largest cost of a predicted held-out event (decision 41)"};
  /// Share of the cost without the effect up to which an unseen event is predicted [-].
  Threshold falls{"held_out.falls", 0.1, "share of the cost without the effect",
                  "a held-out event whose cost falls to this share is predicted too (decision 41)"};
  /// Share of one event in the total cost reduction, above which the effect is considered to act in this
  /// event only [-].
  Threshold alone{"held_out.alone", 0.8, "share of the cost reduction on held-out events",
                  "an effect counts as acting in a single event if that event has a larger share; the other "
                  "events then cannot predict it"};
  /// Share of chi2 that must remain in the event of `alone` when the fit excludes this event [-].
  Threshold unpredicted{
      "held_out.unpredicted", 0.5, "share of that event's chi2",
      "an effect counts as acting in a single event if, in addition, a larger share of that "
      "event's chi2 remains when the fit excludes the event"};
};
inline constexpr HeldOut held_out;  ///< the thresholds in use

/// Limits of a residual that counts as noise; adequacy.hpp lists the commands that use them.
struct Adequacy {
  /// Limit of the reduced chi-square [chi2 per value].
  Threshold reduced_chi2{
      "adequacy.reduced_chi2", 1.12, "chi2 per value",
      "limit of adequacy; splines through noisy samples of the played-in voltage cause a reduced "
      "chi-square up to this (decisions 16 and 17)"};
  /// Limit of the power of the whitened residual's means over 0.5 to 2 s, above that of white noise [standard
  /// deviations].
  Threshold slow{
      "adequacy.slow", 8, "standard deviations",
      "limit of the power of the residual's means over 0.5 to 2 s, above that of white noise; thirty "
      "development cases without a hidden effect had 3.9 at most (measured 2026-11-21)"};
  /// Limit of the chi2 that a steady oscillation explains [chi2].
  Threshold line{
      "adequacy.line", 40, "chi2 above its penalty",
      "limit of the chi2 that a steady oscillation of the residual explains, equal to evidence.accepted; the "
      "strongest oscillation of 75 cases without a hidden effect had 18 at most (measured 2026-11-26)"};
  /// Penalty for each fitted number of a steady oscillation [chi2].
  Threshold number{"adequacy.number", 2, "chi2 per number",
                   "penalty for each fitted number of a steady oscillation (Akaike 1974)"};
  /// Distance of an event's limit from the expected reduced chi-square [standard deviations].
  Threshold one_in_thousand{
      "adequacy.one_in_thousand", 3.09, "standard deviations",
      "one-sided quantile of the normal distribution: noise alone exceeds an event's limit once "
      "in a thousand (calibrate, add)"};
  /// Probability that noise alone exceeds the bound of any bin [-].
  Threshold false_alarm{
      "adequacy.false_alarm", 0.001, "probability",
      "probability that noise alone exceeds the bound of any bin in all error maps of compare"};
};
inline constexpr Adequacy adequacy;  ///< the thresholds in use

/// Values of the reduced chi-square above which something other than noise dominates a fit.
struct Noise {
  /// Reduced chi-square up to which the noise is estimated from the residual [chi2 per value].
  Threshold measurable{"noise.measurable", 4, "chi2 per value",
                       "largest reduced chi-square at which the noise is estimated from the residual of an "
                       "incomplete model, because its reactances are accurate enough (decision 16)"};
  /// Reduced chi-square above which a fit updates the weight of its priors while it improves [chi2 per
  /// value].
  Threshold believed{
      "noise.believed", 1.5, "chi2 per value",
      "above it a fit updates the weight of its priors, the reduced chi-square, while it improves "
      "(decision 15)"};
  /// Reduced chi-square up to which calibrate corrects the bias from voltage noise [chi2 per value].
  Threshold taken_back{"noise.taken_back", 1.5, "chi2 per value",
                       "largest reduced chi-square at which calibrate corrects the bias from voltage noise; "
                       "above it other biases dominate (decision 17)"};
};
inline constexpr Noise noise;  ///< the thresholds in use

/// Selection of the hypotheses that are fitted, and of the effort.
struct Search {
  /// Largest error of a predicted gain in chi2 [-].
  Threshold near{
      "search.near", 0.1, "share of the best gain",
      "hypotheses whose predicted gain is within this share of the best one are fitted with the whole plant "
      "(decision 61)"};
  /// Least share of the better inferred input's gain in chi2 at which blocks of the other input (torque or
  /// field voltage) are identified too [-].
  Threshold fair{
      "search.fair", 0.2, "share of the best gain",
      "blocks of the excitation or mechanical side are identified if the inferred input of that side reduces "
      "chi2 by at least this share of the best reduction (decision 61)"};
  /// Largest difference in chi2 between two runs of one model with different step sizes [chi2].
  Threshold other_steps{
      "search.other_steps", 4, "chi2",
      "largest numerical difference between two runs of one model, because additional states change the step "
      "sizes"};
};
inline constexpr Search search;  ///< the thresholds in use

/// Search for user-defined models of the inferred input, torque or field voltage (decision 21).
struct UserModels {
  /// Largest share of the base model's chi2 that may remain with an inferred input for a user-defined model
  /// to be searched, unless the remaining residual counts as noise [-].
  Threshold explains{"user_models.explains", 0.3, "share of the base model's chi2",
                     "largest share that may remain with the inferred input if a user-defined model is "
                     "searched, unless the remainder is within noise (decision 21)"};
  /// Largest ratio of chi2 at which models of the other inferred input are searched too [-].
  Threshold as_much{
      "user_models.as_much", 1.5, "ratio of chi2",
      "largest ratio of the chi2 of the other inferred input to that of the better one, at which "
      "models of the other input are searched too (decision 21)"};
  /// Least share of the inferred input that a fitted user-defined model explains [-].
  Threshold least_explained{"user_models.least_explained", 0.3, "share of the inferred input",
                            "user-defined models that explain less are not fitted (decision 21)"};
  /// Reduced chi-square of the first fit above which a user-defined model is not judged [chi2 per value].
  Threshold judged_below{
      "user_models.judged_below", 2, "chi2 per value",
      "user-defined models whose first fit has a larger reduced chi-square are not judged (decision 21)"};
  /// Additional evidence for a user-defined model that depends on the record's time [chi2].
  Threshold own_time{"user_models.own_time", 6, "chi2",
                     "additional evidence required of a model that depends on the record's time, which is "
                     "meaningful only if all records start at the same time before the event (decision 21)"};
  /// Additional evidence for a user-defined model whose output is proportional to the initial value [chi2].
  Threshold in_proportion{
      "user_models.in_proportion", 3, "chi2",
      "additional evidence required of a model whose output is proportional to the initial value "
      "(decision 21)"};
};
inline constexpr UserModels user_models;  ///< the thresholds in use

/// `swingbank add`: the user has named the effect, so only two hypotheses compete. Diagnose requires four
/// times the evidence because it selects the best of about thirty, some of which fit by chance.
struct Addition {
  /// Evidence above which a named effect is added [chi2].
  Threshold strong{
      "addition.strong", 10, "chi2",
      "least evidence of an effect named by the user, if every held-out event improves or is within noise: "
      "very strong evidence of one hypothesis against one other (Kass and Raftery, JASA 90, "
      "1995); diagnose selects the best of many and needs evidence.accepted"};
  /// Evidence at or below which an earlier addition is removed [chi2].
  Threshold stays{"addition.stays", 0, "chi2",
                  "an earlier addition is removed if its evidence, given the later additions, falls to this"};
};
inline constexpr Addition addition;  ///< the thresholds in use

/// Thresholds of the statements about a parameter in calibrate and in the tables (decision 17).
struct Parameters {
  /// Prior standard deviation of a model's parameters, relative [-].
  Threshold prior_sd{
      "parameters.prior_sd", 0.2, "relative",
      "prior standard deviation of a model's parameters, unless --prior-sd is given (decision 15)"};
  /// Reduction of a parameter's variance by the records, below which the parameter is not identified [-].
  Threshold identified{"parameters.identified", 0.5, "share determined by the records",
                       "parameters, or combinations of parameters, below this are not identified"};
  /// Least component of a parameter in a combination that is not identified, for the parameter to be listed
  /// [-].
  Threshold member{"parameters.member", 0.3, "component of a unit vector",
                   "least component of a parameter in a combination that is not identified"};
  /// Largest ratio of standard errors for which a further event is recommended [-].
  Threshold narrowed{
      "parameters.narrowed", 0.8, "ratio of standard errors",
      "a further event is recommended if it reduces a parameter's standard error below this ratio"};
  /// Largest relative difference in cost at which two starts count as having reached the same optimum [-].
  Threshold agrees{
      "parameters.agrees", 0.01, "share of the cost",
      "largest relative difference in cost from the best start, for a start that reached the same "
      "optimum; the limit is at least agrees_least"};
  /// Least absolute difference in cost for `agrees` [chi2].
  Threshold agrees_least{"parameters.agrees_least", 1, "chi2",
                         "least limit of agrees: cost of one standard error of a parameter"};
  /// Change above which the verdict names a calibrated parameter [standard errors].
  Threshold moved{"parameters.moved", 2, "standard errors",
                  "the verdict names parameters that calibration changed by more"};
  /// Change above which a fitted value is noted [standard deviations].
  Threshold beyond_prior{"parameters.beyond_prior", 2.5, "prior standard deviations",
                         "a note names values that are fitted further from the prior mean"};
};
inline constexpr Parameters parameters;  ///< the thresholds in use

/// Limit of a channel's error relative to its movement, the deviation from its value before the event. A
/// limit in % of MVA alone would accept a model without any response, if the measured response is small.
struct Movement {
  /// Limit of the RMS error after the last switching, relative to the channel's RMS movement [%].
  Threshold error{
      "movement.error", 25, "% of movement",
      "RMS of modelled - measured over RMS of the measured deviation from before the event, of P and of "
      "Q after the last switching (Swingbank's own; MOD-026-2 asks for a guideline and sets no figure)"};
  /// Least ratio of movement to noise for this limit [-].
  Threshold over_noise{
      "movement.over_noise", 5, "noise",
      "least ratio of a channel's RMS movement to its noise at which movement.error applies; "
      "below it noise alone uses most of the limit"};
  /// Least movement for this limit [% of MVA].
  Threshold least{"movement.least", 1, "% of MVA",
                  "least RMS movement of a channel at which movement.error applies"};
};
inline constexpr Movement movement;  ///< the limits in use

}  // namespace swingbank::validate::thresholds
