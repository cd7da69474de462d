#pragma once
// Every number that decides a verdict: limits of noise, evidence, prediction and adequacy. One struct per
// stage, one record per threshold; `swingbank diagnose --thresholds` prints them all. Numbers that only
// control the effort of a search (steps, starts, rounds) are defined with the search.
#include <string_view>

namespace swingbank::validate::thresholds {

/// A number that decides a verdict, with its name, unit and reason.
struct Threshold {
  std::string_view name;  ///< stage.field
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
      "diagnose accepts an effect from here; the best of some thirty wrong ones had 20 at most in thirty "
      "development cases with nothing hidden (decisions 16 and 41)"};
  /// Additional evidence of a pair of effects over every single effect [chi2].
  Threshold second{
      "evidence.second", 80, "chi2",
      "a pair of effects leaves that much less than every single one, in evidence and in chi2, because "
      "what the first effect or the instruments leave looks like a second one (decision 61)"};
  /// Largest gain in evidence that a longer fit is expected to bring [chi2].
  Threshold within_reach{
      "evidence.within_reach", 200, "chi2",
      "a long fit may add this much to a short one; what lies further behind the best is neither "
      "fitted on for that reason nor judged (decision 61)"};
  /// Share of the leading extension's evidence from which a better optimum of the base model restarts the
  /// diagnosis [-].
  Threshold escape{
      "evidence.escape", 0.5, "share of the leading extension's evidence",
      "where a better start of the model alone explains more, the diagnosis begins anew (decision 61)"};
  /// Largest difference in chi2 at which a completed fit replaces a short one [chi2].
  Threshold same_fit{
      "evidence.same_fit", 0.5, "chi2",
      "a finished fit takes the place of a short one, which has no errors, unless it is worse by more"};
};
inline constexpr Evidence evidence;  ///< the thresholds in use

/// Conversion of evidence to posterior probabilities (decision 41).
struct Posterior {
  /// Divisor that tempers the evidence before its conversion to a probability [chi2].
  Threshold scale{
      "posterior.scale", 6, "chi2",
      "an evidence counts as twice a log probability times this: fits end short of their optima, and noise is "
      "not all modelled; the likelihood of 21 blind cases of spent seeds is flat from 4 to 6 (decision 41)"};
  /// Total probability of the set of credible explanations [-].
  Threshold set{"posterior.set", 0.95, "probability",
                "the most probable explanations that make up this much are the set (decision 41)"};
  /// Probability above which the verdict names the first explanation of the set [-].
  Threshold told{"posterior.told", 0.5, "probability",
                 "which of the set comes first is told above this (decision 41)"};
  /// Probability relative to the leading explanation below which a fit is not continued [-].
  Threshold negligible{"posterior.negligible", 1e-4, "probability beside the leading one",
                       "what cannot become more probable is not fitted on (decision 61)"};
};
inline constexpr Posterior posterior;  ///< the thresholds in use

/// Thresholds of the hold-out test of an effect on unseen events (decision 41).
struct HeldOut {
  /// Largest ratio of the costs with and without the effect on an unseen event [-].
  Threshold worse{
      "held_out.worse", 1.02, "ratio of costs",
      "an event in which the effect hardly acts may be predicted worse by this: the refit's own scatter "
      "(decision 41)"};
  /// Largest increase of the cost of an unseen event [chi2].
  Threshold costs{
      "held_out.costs", 20, "chi2",
      "an effect may cost no unseen event more, or costs_share if that is more; what is really missing "
      "costs nothing (decision 41)"};
  /// Largest increase of the cost of an unseen event, as a share of the effect's evidence [-].
  Threshold costs_share{"held_out.costs_share", 0.1, "share of the effect's evidence",
                        "see costs (decision 41)"};
  /// Cost per value up to which an unseen event is predicted [chi2 per value].
  Threshold predicts{"held_out.predicts", 1.25, "chi2 per value",
                     "an unseen event with this cost at most is predicted (decision 41)"};
  /// Share of the cost without the effect up to which an unseen event is predicted [-].
  Threshold falls{"held_out.falls", 0.1, "share of the cost without the effect",
                  "an unseen event whose cost falls to this is predicted too (decision 41)"};
  /// Share of the total reduction from which the effect acts in one event only [-].
  Threshold alone{
      "held_out.alone", 0.8, "share of what the effect saves on unseen events",
      "an effect shows in one event alone if that event holds more; no other event can foretell it then"};
  /// Share of such an event's chi2 that must remain when the fit excludes it [-].
  Threshold foretold{"held_out.foretold", 0.5, "share of that event's chi2",
                     "and if the others, fitted without it, leave more of it than this"};
};
inline constexpr HeldOut held_out;  ///< the thresholds in use

/// Limits of a residual that counts as noise; adequacy.hpp lists the commands that use them.
struct Adequacy {
  /// Limit of the reduced chi-square [chi2 per value].
  Threshold reduced_chi2{
      "adequacy.reduced_chi2", 1.12, "chi2 per value",
      "splines through noisy samples of the played-in voltage leave up to this (decisions 16 and 17)"};
  /// Limit of the means of the whitened residual over 0.5 to 2 s [standard deviations].
  Threshold slow{
      "adequacy.slow", 8, "standard deviations",
      "means of the residual over 0.5 to 2 s may exceed those of white noise by this; thirty development "
      "cases with nothing hidden had 3.9 at most (measured 2026-11-21)"};
  /// Limit of the chi2 that a steady oscillation explains [chi2].
  Threshold line{
      "adequacy.line", 40, "chi2 beyond its price",
      "a steady oscillation in what is left has to earn what an effect has to; the strongest line of 75 "
      "cases with nothing hidden earned 18 at most (measured 2026-11-26)"};
  /// Penalty for each fitted number of a steady oscillation [chi2].
  Threshold number{"adequacy.number", 2, "chi2 per number",
                   "what each number of a steady oscillation must earn (Akaike 1974)"};
  /// Standard deviations of an event's limit above the expected chi-square [standard deviations].
  Threshold one_in_thousand{
      "adequacy.one_in_thousand", 3.09, "standard deviations",
      "one-sided quantile of the normal distribution: noise alone exceeds an event's limit once "
      "in a thousand (calibrate, add)"};
  /// Probability that noise alone exceeds the bound of any bin [-].
  Threshold false_alarm{
      "adequacy.false_alarm", 0.001, "probability",
      "with which noise alone exceeds any of the cells of all of compare's error maps together"};
};
inline constexpr Adequacy adequacy;  ///< the thresholds in use

/// Values of the reduced chi-square above which something other than noise dominates a fit.
struct Noise {
  /// Reduced chi-square up to which the noise is estimated from the residual [chi2 per value].
  Threshold measurable{
      "noise.measurable", 4, "chi2 per value",
      "noise can be measured through a structure that misfits by less, because its reactances are "
      "near enough (decision 16)"};
  /// Reduced chi-square up to which the priors keep their full weight [chi2 per value].
  Threshold believed{"noise.believed", 1.5, "chi2 per value",
                     "up to this misfit beliefs about parameters weigh as they stand (decision 15)"};
  /// Reduced chi-square up to which calibrate corrects the bias from voltage noise [chi2 per value].
  Threshold taken_back{
      "noise.taken_back", 1.5, "chi2 per value",
      "up to this misfit calibrate takes back what noise of the voltage did; above it something else "
      "pulls harder (decision 17)"};
};
inline constexpr Noise noise;  ///< the thresholds in use

/// Selection of the hypotheses that are fitted, and of the effort.
struct Search {
  /// Reduced chi-square below which a hypothesis is fitted with the whole plant [chi2 per value].
  Threshold nearly_fits{
      "search.nearly_fits", 1.5, "chi2 per value",
      "what leaves less is fitted with the whole plant, however far behind identification saw it (decision 61)"};
  /// Share of the better input's gain from which the blocks of the other side are identified [-].
  Threshold fair{
      "search.fair", 0.2, "share of the best gain",
      "blocks of a side are identified if its input, free in time, takes off as much (decision 61)"};
  /// Largest difference in chi2 between two runs of one model with different step sizes [chi2].
  Threshold other_steps{"search.other_steps", 4, "chi2",
                        "two runs of one model may differ by this, because other states make other steps"};
};
inline constexpr Search search;  ///< the thresholds in use

/// Search for user-defined models of the inferred input (decision 21).
struct Laws {
  /// Largest share of the base model's chi2 that an input may leave to justify a user-defined model [-].
  Threshold explains{"laws.explains", 0.3, "share of the base's misfit",
                     "an input is worth a law if it leaves no more: it takes away 70 % (decision 21)"};
  /// Largest ratio of chi2 at which the other input is searched too [-].
  Threshold as_much{
      "laws.as_much", 1.5, "ratio of misfits",
      "an input explains as much as the better one if it leaves no more than this many times what that "
      "leaves (decision 21)"};
  /// Least share of the inferred input that a fitted user-defined model explains [-].
  Threshold least_explained{"laws.least_explained", 0.3, "share of the inferred input",
                            "a law that explains less is not fitted (decision 21)"};
  /// Reduced chi-square of the first fit above which a user-defined model is not judged [chi2 per value].
  Threshold judged_below{"laws.judged_below", 2, "chi2 per value",
                         "judging a law is in vain if its first fit leaves more (decision 21)"};
  /// Additional evidence for a user-defined model of the record's own time [chi2].
  Threshold own_time{
      "laws.own_time", 6, "chi2",
      "a law of the record's own time must be better by this, because it means something only where "
      "records begin alike (decision 21)"};
  /// Additional evidence for a user-defined model in proportion to the initial value [chi2].
  Threshold in_proportion{"laws.in_proportion", 3, "chi2",
                          "a law in proportion to the start must be better by this than one that is not "
                          "(decision 21)"};
};
inline constexpr Laws laws;  ///< the thresholds in use

/// `swingbank add`: the user has named the effect, so one hypothesis competes with one other. Diagnose
/// requires four times the evidence because it selects the best of about thirty, some of which fit by chance.
struct Addition {
  /// Evidence above which a named effect is added [chi2].
  Threshold strong{
      "addition.strong", 10, "chi2",
      "an effect that a person names earns its place above this, if no unseen event is worse with it: "
      "strong evidence of one hypothesis against one other (Kass and Raftery, JASA 90, 1995: 6 to 10); "
      "the best of many, which diagnose takes, needs evidence.accepted"};
  /// Evidence at or below which an earlier addition is removed [chi2].
  Threshold stays{"addition.stays", 0, "chi2",
                  "an effect added before is taken out again if what came later leaves it no more"};
};
inline constexpr Addition addition;  ///< the thresholds in use

/// Statements of calibrate and the tables on a parameter (decision 17).
struct Parameters {
  /// Prior standard deviation of a model's parameters, relative [-].
  Threshold spread{"parameters.spread", 0.2, "relative",
                   "standard deviation believed of a model's parameters, unless --spread says otherwise "
                   "(decision 15)"};
  /// Share decided by the records below which a parameter is not identified [-].
  Threshold identified{
      "parameters.identified", 0.5, "share decided by the records",
      "a parameter, or a direction of several, that the records decide less is not identified"};
  /// Component of a poorly identified direction from which a parameter belongs to it [-].
  Threshold member{"parameters.member", 0.3, "component of a unit vector",
                   "a parameter belongs to a group that the records cannot tell apart from here"};
  /// Largest ratio of standard errors for which a further event is recommended [-].
  Threshold narrowed{"parameters.narrowed", 0.8, "ratio of standard errors",
                     "a further event is recommended if it narrows a parameter's error to less"};
  /// Largest relative difference in cost at which two starts reached the same optimum [-].
  Threshold agrees{
      "parameters.agrees", 0.01, "share of the cost",
      "a start that ends this near the best one came to the same optimum; agrees_least if that is more"};
  /// Least value of that difference [chi2].
  Threshold agrees_least{"parameters.agrees_least", 1, "chi2", "what one parameter's standard error costs"};
  /// Change above which the verdict names a calibrated parameter [standard errors].
  Threshold moved{"parameters.moved", 2, "standard errors",
                  "a parameter that calibration moved by more is named in the verdict"};
  /// Change above which a fitted value is noted [standard deviations].
  Threshold beyond_prior{"parameters.beyond_prior", 2.5, "standard deviations of the belief",
                         "a fitted value further from the model's is noted"};
};
inline constexpr Parameters parameters;  ///< the thresholds in use

/// Fit for purpose: engineering limits of a model's errors in each window, with the error measures of IEC
/// 61400-27-2, which sets no limits itself. The limits are those of RTE's connection code, for a measured and
/// for a simulated reference; `--accept` selects others (acceptance.hpp).
struct DtrTest {
  /// Limit of the maximum absolute error before the first switching [% of MVA].
  Threshold pre_fault_mxe{
      "dtr_test.pre_fault_mxe", 8, "% of MVA",
      "maximum of |modelled - measured| of P and of Q, before the first switching (RTE, DTR fiche I16, reference measured)"};
  /// Limit of the absolute mean error before the first switching [% of MVA].
  Threshold pre_fault_me{
      "dtr_test.pre_fault_me", 4, "% of MVA",
      "|mean of modelled - measured| of P and of Q, before the first switching (RTE, DTR fiche I16, reference measured)"};
  /// Limit of the mean absolute error before the first switching [% of MVA].
  Threshold pre_fault_mae{
      "dtr_test.pre_fault_mae", 7, "% of MVA",
      "mean of |modelled - measured| of P and of Q, before the first switching (RTE, DTR fiche I16, reference measured)"};
  /// Limit of the maximum absolute error between the first and the last switching [% of MVA].
  Threshold fault_mxe{
      "dtr_test.fault_mxe", 10, "% of MVA",
      "maximum of |modelled - measured| of P and of Q, between the first and the last switching (RTE, DTR fiche I16, reference measured)"};
  /// Limit of the absolute mean error between the first and the last switching [% of MVA].
  Threshold fault_me{
      "dtr_test.fault_me", 5, "% of MVA",
      "|mean of modelled - measured| of P and of Q, between the first and the last switching (RTE, DTR fiche I16, reference measured)"};
  /// Limit of the mean absolute error between the first and the last switching [% of MVA].
  Threshold fault_mae{
      "dtr_test.fault_mae", 8, "% of MVA",
      "mean of |modelled - measured| of P and of Q, between the first and the last switching (RTE, DTR fiche I16, reference measured)"};
  /// Limit of the maximum absolute error after the last switching [% of MVA].
  Threshold post_fault_mxe{
      "dtr_test.post_fault_mxe", 8, "% of MVA",
      "maximum of |modelled - measured| of P and of Q, after the last switching (RTE, DTR fiche I16, reference measured)"};
  /// Limit of the absolute mean error after the last switching [% of MVA].
  Threshold post_fault_me{
      "dtr_test.post_fault_me", 4, "% of MVA",
      "|mean of modelled - measured| of P and of Q, after the last switching (RTE, DTR fiche I16, reference measured)"};
  /// Limit of the mean absolute error after the last switching [% of MVA].
  Threshold post_fault_mae{
      "dtr_test.post_fault_mae", 7, "% of MVA",
      "mean of |modelled - measured| of P and of Q, after the last switching (RTE, DTR fiche I16, reference measured)"};
  /// Time after the first switching that is not compared [s].
  Threshold after_fault{"dtr_test.after_fault", 0.02, "s",
                        "not compared after the first switching (RTE, DTR fiche I16, reference measured)"};
  /// Time after the last switching that is not compared [s].
  Threshold after_clearing{"dtr_test.after_clearing", 0.06, "s",
                           "not compared after the last switching (RTE, DTR fiche I16, reference measured)"};
};
inline constexpr DtrTest dtr_test;  ///< the limits in use
/// The same for a simulated reference.
struct DtrSimulation {
  /// Limit of the maximum absolute error before the first switching [% of MVA].
  Threshold pre_fault_mxe{
      "dtr_simulation.pre_fault_mxe", 5, "% of MVA",
      "maximum of |modelled - measured| of P and of Q, before the first switching (RTE, DTR fiche I16, reference simulated)"};
  /// Limit of the absolute mean error before the first switching [% of MVA].
  Threshold pre_fault_me{
      "dtr_simulation.pre_fault_me", 2, "% of MVA",
      "|mean of modelled - measured| of P and of Q, before the first switching (RTE, DTR fiche I16, reference simulated)"};
  /// Limit of the mean absolute error before the first switching [% of MVA].
  Threshold pre_fault_mae{
      "dtr_simulation.pre_fault_mae", 3, "% of MVA",
      "mean of |modelled - measured| of P and of Q, before the first switching (RTE, DTR fiche I16, reference simulated)"};
  /// Limit of the maximum absolute error between the first and the last switching [% of MVA].
  Threshold fault_mxe{
      "dtr_simulation.fault_mxe", 8, "% of MVA",
      "maximum of |modelled - measured| of P and of Q, between the first and the last switching (RTE, DTR fiche I16, reference simulated)"};
  /// Limit of the absolute mean error between the first and the last switching [% of MVA].
  Threshold fault_me{
      "dtr_simulation.fault_me", 5, "% of MVA",
      "|mean of modelled - measured| of P and of Q, between the first and the last switching (RTE, DTR fiche I16, reference simulated)"};
  /// Limit of the mean absolute error between the first and the last switching [% of MVA].
  Threshold fault_mae{
      "dtr_simulation.fault_mae", 7, "% of MVA",
      "mean of |modelled - measured| of P and of Q, between the first and the last switching (RTE, DTR fiche I16, reference simulated)"};
  /// Limit of the maximum absolute error after the last switching [% of MVA].
  Threshold post_fault_mxe{
      "dtr_simulation.post_fault_mxe", 5, "% of MVA",
      "maximum of |modelled - measured| of P and of Q, after the last switching (RTE, DTR fiche I16, reference simulated)"};
  /// Limit of the absolute mean error after the last switching [% of MVA].
  Threshold post_fault_me{
      "dtr_simulation.post_fault_me", 2, "% of MVA",
      "|mean of modelled - measured| of P and of Q, after the last switching (RTE, DTR fiche I16, reference simulated)"};
  /// Limit of the mean absolute error after the last switching [% of MVA].
  Threshold post_fault_mae{
      "dtr_simulation.post_fault_mae", 3, "% of MVA",
      "mean of |modelled - measured| of P and of Q, after the last switching (RTE, DTR fiche I16, reference simulated)"};
  /// Time after the first switching that is not compared [s].
  Threshold after_fault{"dtr_simulation.after_fault", 0.02, "s",
                        "not compared after the first switching (RTE, DTR fiche I16, reference simulated)"};
  /// Time after the last switching that is not compared [s].
  Threshold after_clearing{"dtr_simulation.after_clearing", 0.06, "s",
                           "not compared after the last switching (RTE, DTR fiche I16, reference simulated)"};
};
inline constexpr DtrSimulation dtr_simulation;  ///< the limits in use
/// Limit of a channel's error relative to its movement. A limit in % of MVA alone passes a unit whose whole
/// response is missing if that response is small.
struct Movement {
  /// Limit of the RMS error after the last switching, relative to the channel's RMS movement [%].
  Threshold error{
      "movement.error", 25, "% of movement",
      "RMS of modelled - measured over RMS of the measured deviation from before the event, of P and of "
      "Q after the last switching (Swingbank's own; MOD-027 asks for a guideline and sets no figure)"};
  /// Least ratio of movement to noise for this limit [-].
  Threshold over_noise{
      "movement.over_noise", 5, "noise",
      "a channel whose RMS movement is less times its noise is not held to movement.error, of which "
      "noise alone would then take most"};
  /// Least movement for this limit [% of MVA].
  Threshold least{"movement.least", 1, "% of MVA",
                  "a channel whose RMS movement is less is not held to movement.error"};
};
inline constexpr Movement movement;  ///< the limits in use

}  // namespace swingbank::validate::thresholds
