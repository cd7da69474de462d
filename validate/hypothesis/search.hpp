#pragma once
// Trial of each hypothesis alone on one base model. The results are in descending order of evidence.
// Afterwards judge() tests the leading hypotheses on unseen events.
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "validate/event/progress.hpp"
#include "validate/hypothesis/judge.hpp"
#include "validate/reduced/free_input.hpp"
#include "validate/reduced/identify.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::hypothesis {

/// Base model of a search: a structure to which a hypothesis may be added.
struct BaseModel {
  const noise::WhitenedEvents& events;         ///< events with their noise model
  sim::plant::Plant plant;                     ///< plant at the nominal values, the centres of the priors
  sim::Conventions conventions;                ///< conventions of the model
  const sim::library::EffectLibrary& library;  ///< source of the effects
  const fit::Fit& fit;                         ///< fit of this base model
  /// Parameters of effects added before, with their IDs in `plant`.
  std::vector<fit::FreeParameter> own = {};
  std::string with = {};  ///< name of the effect added before; empty: the given model
  double prior_sd = thresholds::parameters.prior_sd;  ///< prior standard deviation of the model's parameters
  int threads = 1;                                    ///< number of threads
  /// Cost (fit::penalised) above which no hypothesis can be accepted.
  double required = std::numeric_limits<double>::infinity();
  /// Returns whether the user has asked to stop; results so far are then kept. May be empty.
  std::function<bool()> stop = {};
  /// Inputs inferred with this base model, free functions of time; null: not yet inferred.
  const reduced::FreeInput *torque = nullptr, *field = nullptr;  ///< inferred inputs
  /// Called with each hypothesis's fit, also after an interruption, from any thread. May be empty.
  std::function<void(const fit::Fit&)> reached = {};
  /// Returns whether the user has asked to stop.
  [[nodiscard]] bool stopped() const { return stop && stop(); }
  /// Returns references to plant and conventions; the base model must outlive them.
  [[nodiscard]] sim::plant::PlantUnderTest under_test() const { return {plant, conventions}; }
  /// Returns the part of a plant that the events record.
  [[nodiscard]] record::Component component() const {
    return events.empty() ? record::Component::plant : events.front().record.component;
  }
  /// Returns every hypothesis that these events can test (all_hypotheses()).
  [[nodiscard]] std::vector<Hypothesis> hypotheses() const;
};

/// Fits the hypotheses without judging them. Returns them in descending order of evidence, without those that
/// have no influence. `gain` is relative to the base model's fit.
std::vector<Judgement> try_hypotheses(const BaseModel& base_model, std::vector<Hypothesis> all,
                                      const event::Progress& report = {});

/// Calls act(k) for k = 0 to n-1 in parallel until the user asks to stop, and reports each finished
/// hypothesis under `name(k)`, with the name of the effect added before.
void for_each_hypothesis(const BaseModel& base_model, const event::Progress& report, event::Phase phase,
                         std::size_t n, const std::function<std::string(std::size_t)>& name,
                         const std::function<void(std::size_t)>& act);

/// Calls fit::fit for a hypothesis on this base model and reports the result to BaseModel::reached.
fit::Fit fit_at(const BaseModel& base_model, const sim::plant::PlantUnderTest& tested,
                const std::vector<fit::FreeParameter>& free, const fit::FitOptions& options);

/// Returns the free parameters of a base model: those of the given model, and those of effects added before.
std::vector<fit::FreeParameter> free_with_own(const BaseModel& base_model);
/// Returns the plant at its prior mean with the parameters that the identification of `h` draws and frees.
reduced::Trial trial_of(const BaseModel& base_model, const Hypothesis& h);
/// Returns whether a hypothesis with the predicted cost `predicted` cannot be accepted. `none`: predicted
/// cost of the base model. The prediction may be wrong by search.near.
bool cannot_be_accepted(const BaseModel& base_model, double predicted, double none);
/// Returns the reason why a hypothesis with this predicted reduction of chi2 is not fitted.
std::string too_small(double gain);

/// Returns the plant at its prior mean: the hypothesis at its first start values, and parameters of effects
/// added before at their prior means.
sim::plant::Plant prior_mean(const BaseModel& base_model, const Hypothesis& h);

/// Returns the fit of the hypothesis with the standard errors that its evidence requires, or `f` if they
/// cannot be computed.
fit::Fit with_errors(const BaseModel& base_model, const Hypothesis& h, const fit::Fit& f);

/// Fits a hypothesis that the search has not fitted, from its start values.
void fit_alone(const BaseModel& base_model, Judgement& j);

/// Fits `h` from the end point of `other`, the fit of another structure. Parameters that the other structure
/// lacks start at their values in `start`, a plant of the structure of `h`.
fit::Fit fit_from(const BaseModel& base_model, const Hypothesis& h, const fit::Fit& other,
                  const sim::plant::Plant& start);

/// Refits `j` from the end point of `other`, the fit of another structure, and keeps the better fit.
void try_from(const BaseModel& base_model, const fit::Fit& other, Judgement& j);

/// Returns the base model to which the hypothesis of `j` has been added.
BaseModel after(const BaseModel& base_model, const Judgement& j);

/// Adds the parameters of the effects added before to the free parameters of `h`. Their start values are
/// their fitted values.
void bring(const BaseModel& base_model, Hypothesis& h);

/// Returns the candidates for replacing a pair's first effect while its second effect stays. These are all
/// effects of the first effect's slot, and the accepted hypotheses of `alone` (single effects). They are not
/// fitted; `fit` contains only start values and states. The start values of the second effect are from the
/// pair's fit. All others are from the candidate's fit in `alone` or, without such a fit, from the pair's
/// fit.
std::vector<Judgement> exchanges(const BaseModel& base_model, const Judgement& pair,
                                 const std::vector<Judgement>& alone);
/// Fits a candidate of exchanges() or crossed() from its start. Does nothing if the candidate has no start.
void try_begun(const BaseModel& base_model, Judgement& j);
/// A new pair that consists of one effect from each of two tried pairs.
struct Cross {
  std::string joins;          ///< name of the effect taken from the better pair
  const Judgement* joins_in;  ///< the better pair, whose machine parameters are used
  std::string stays;          ///< name of the effect taken from the worse pair
  const Judgement* stays_in;  ///< the worse pair
  /// Predicted evidence: that of both pairs minus that of the pair of their other effects. The prediction
  /// assumes that reductions of chi2 add up.
  double expected;
};
/// Returns the cross with the highest expected evidence; empty if there is none. The two effects of a cross
/// have not been tried as a pair, but their partners have.
std::optional<Cross> best_cross(std::span<const Judgement> pairs);
/// Returns the pair of a cross, not fitted. If one of its effects cannot be added without another, only the
/// names are set.
Judgement crossed(const BaseModel& base_model, const Cross& cross);

}  // namespace swingbank::validate::hypothesis
