#pragma once
// Every hypothesis tried by itself on one structure, in order of its evidence. Judging the leading ones on
// unseen events comes after (judge).
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "validate/event/progress.hpp"
#include "validate/hypothesis/judge.hpp"
#include "validate/reduced/free_input.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::hypothesis {

/// A structure that a hypothesis may be added to.
struct Stage {
  const event::WhitenedEvents& events;
  sim::plant::Plant plant;  ///< holds the nominal values, which beliefs are about
  sim::Conventions conventions;
  const sim::library::EffectLibrary& library;  ///< whose effects may be added
  const fit::Fit& fit;                         ///< of this structure
  std::vector<fit::FreeParameter> own =
      {};                 ///< parameters that earlier stages brought, as numbered in `plant`
  std::string with = {};  ///< name of what was added; empty: the model as it was given
  double spread = thresholds::parameters.spread;  ///< believed of the model's parameters
  int threads = 1;
  /// Whether a person has asked for an end: what was begun is kept as it is then. May be empty.
  std::function<bool()> stop = {};
  /// Inputs that are free in time beside this structure; null: not known yet.
  const reduced::FreeInput *torque = nullptr, *field = nullptr;
  /// Called with what a fit of a hypothesis has reached, an interrupted one included; from any thread. May be
  /// empty.
  std::function<void(const fit::Fit&)> reached = {};
  [[nodiscard]] bool stopped() const { return stop && stop(); }
  [[nodiscard]] sim::plant::PlantUnderTest under_test() const { return {plant, conventions}; }
  /// What of a plant the events are of.
  [[nodiscard]] record::Component component() const {
    return events.empty() ? record::Component::plant : events.front().record.component;
  }
};

/// Fits the hypotheses and does not judge them. Returns the best first and leaves out those that change
/// nothing. `gain` is over the stage's fit.
std::vector<Judgement> try_hypotheses(const Stage& stage, std::vector<Hypothesis> all,
                                      const event::Progress& report = {});

/// fit::fit of a hypothesis of this stage, which reports what was reached (Stage::reached).
fit::Fit fit_at(const Stage& stage, const sim::plant::PlantUnderTest& tested,
                const std::vector<fit::FreeParameter>& free, const fit::FitOptions& options);

/// chi2 of each plant with each event at its entry of `states`; infinite where a plant cannot be simulated.
/// The plants differ in values only, and are simulated in lanes.
std::vector<double> chi2_of_each(std::span<const sim::plant::Plant> plants,
                                 const sim::Conventions& conventions, const event::WhitenedEvents& events,
                                 const std::vector<fit::EventState>& states);

/// The plant at its prior mean: the hypothesis at its first start, and the parameters of earlier stages at
/// their prior means.
sim::plant::Plant prior_mean(const Stage& stage, const Hypothesis& h);

/// A fit of the hypothesis with its errors, which its evidence needs; nothing where they cannot be had.
std::optional<fit::Fit> with_errors(const Stage& stage, const Hypothesis& h, const fit::Fit& f);

/// Fits a hypothesis that gave no hope, from its start.
void fit_alone(const Stage& stage, Judgement& j);

/// Fits `j` from where the fit of another structure ended.
void try_from(const Stage& stage, const fit::Fit& other, Judgement& j);

/// The stage at which `j`, added to `stage`, is there already.
Stage after(const Stage& stage, const Judgement& j);

/// Frees in `h` the parameters that earlier stages brought, at their fitted values.
void bring(const Stage& stage, Hypothesis& h);

/// What could stand in the place of a pair's first effect, beside its second one: whatever fills the first
/// one's slot, and those of `alone` that are accepted. These are not fitted. `fit` has the values and states
/// to start from: the first effect's as `alone` found them, the second effect's as the pair has them.
std::vector<Judgement> exchanges(const Stage& stage, const Judgement& pair,
                                 const std::vector<Judgement>& alone);
/// Fits one that `exchanges` or `crossed` has begun, from its start. One that could not be begun stays as it
/// is.
void try_begun(const Stage& stage, Judgement& j);
/// Two effects that were found in two pairs, each beside a partner of the other.
struct Cross {
  std::string joins;          ///< name of the effect that is taken out of the better pair
  const Judgement* joins_in;  ///< the better pair, whose machine is taken as well
  std::string stays;          ///< name of the effect that is taken out of the other pair
  const Judgement* stays_in;
  double
      expected;  ///< evidence of both pairs less that of their partners' pair: what effects take off adds up
};
/// The most promising cross whose two effects are in no pair together, while their partners are.
std::optional<Cross> best_cross(std::span<const Judgement> pairs);
/// The pair of a cross, not fitted. Where one effect needs another to be there, it holds the names alone.
Judgement crossed(const Stage& stage, const Cross& cross);

}  // namespace swingbank::validate::hypothesis
