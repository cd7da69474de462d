#pragma once
// Every hypothesis tried by itself on one structure: started from draws, fitted for a short while, in order
// of its evidence. Judging the leading ones on unseen events comes after (judge).
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "validate/event/progress.hpp"
#include "validate/hypothesis/judge.hpp"
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
  /// What a torque and a field voltage free in time take off the cost of `fit`: no effect that acts through
  /// them alone can take off more. Infinite: not known.
  double by_torque = std::numeric_limits<double>::infinity(), by_field = by_torque;
  [[nodiscard]] bool stopped() const { return stop && stop(); }
  [[nodiscard]] sim::plant::PlantUnderTest under_test() const { return {plant, conventions}; }
  /// What of a plant the events are of.
  [[nodiscard]] record::Component component() const {
    return events.empty() ? record::Component::plant : events.front().record.component;
  }
};

/// Fits the hypotheses and does not judge them. Returns the best first and leaves out those that do not act.
/// `gain` is over the stage's fit.
std::vector<Judgement> try_hypotheses(const Stage& stage, std::vector<Hypothesis> all,
                                      const event::Progress& report = {});

/// chi2 of each plant with each event at its entry of `states`; infinite where a plant cannot be run. The
/// plants differ in values only. Steps are lenient (event::Playing).
std::vector<double> left_by_each(std::span<const sim::plant::Plant> plants,
                                 const sim::Conventions& conventions, const event::WhitenedEvents& events,
                                 const std::vector<fit::EventState>& states);
/// The same of one plant, with steps as of a fit's end.
double left_by(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
               const std::vector<fit::EventState>& states);

/// Goes on where `from` ended, with the parameters that act without a slope: a limiter's timer ends at an
/// instant, and no sensitivity follows an instant. Such parameters of `h` are tried at multiples of their
/// values, and everything is fitted on from the best, as long as that gains. Beliefs are about `believed`.
fit::Fit past_blind(const Stage& stage, const Hypothesis& h, const sim::plant::Plant& believed,
                    fit::Fit from);

/// Whether two starts that leave this chi2 are one: what differs between them acts nowhere.
bool alike(double left, double other);
/// Whether a hypothesis of this gain and slot is fitted on beside the best one: it has a fair share of its
/// gain, is within reach of it, or is a rival of its slot.
struct FittedOn {
  double best;
  int slot;
  double share = thresholds::search.fair;
  bool operator()(double gain, int its_slot) const {
    return best <= 0 || gain >= share * best || gain > best - thresholds::evidence.within_reach ||
           (slot >= 0 && its_slot == slot);
  }
};

/// Fits `j`, as try_hypotheses left it, from further starts, with the machine as the leading hypothesis of
/// its slot found it. A rival must not lose by a poor start.
void try_further(const Stage& stage, const fit::Fit& leader, Judgement& j);

/// Fits `j` on where its fit ended, in rounds, as long as a round is worth it: a fit that was given few steps
/// has not arrived, and how far it came says little of where it goes.
void fit_on(const Stage& stage, Judgement& j);

/// A fit of the hypothesis with its errors, which its evidence needs; nothing where they cannot be had.
std::optional<fit::Fit> with_errors(const Stage& stage, const Hypothesis& h, const fit::Fit& f);

/// Returns `values` of the hypothesis's free parameters, but takes those of its slot from the leader's effect
/// there wherever that has a parameter of the same name and unit. Effects of one slot share the names of
/// their textbooks.
std::vector<double> by_name(const Hypothesis& h, std::vector<double> values, const sim::plant::Plant& leader);

/// Looks for other optima of `j`, whose fit has errors: from draws of its own parameters far from where it
/// ended, and from the values that its rivals have found under the same names, chosen by what they leave with
/// everything else following.
void try_basins(const Stage& stage, Judgement& j, std::span<const sim::plant::Plant> rivals = {});

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
/// Fits one of the exchanges. If it ends behind the pair, it is fitted from further starts with the machine
/// as in the pair.
void try_exchange(const Stage& stage, const Judgement& pair, Judgement& j);

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
