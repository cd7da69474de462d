#include "validate/hypothesis/identified.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/in_parallel.hpp"
#include "validate/hypothesis/companions.hpp"
#include "validate/hypothesis/polish.hpp"

namespace swingbank::validate::hypothesis {
namespace {

using event::InputKind;

/// Number of best hypotheses that are fitted with the whole plant to find the leader.
constexpr std::size_t kLeading = 3;
/// Maximum number of linearisations about a leader. The second one is needed if the leader changes.
constexpr int kLinearPoints = 2;
/// Maximum number of optima that are kept of one hypothesis.
constexpr std::size_t kOptima = 2;
/// Minimum evidence of an inferred input, free in time, for a search on its side: strong on the scale of Kass
/// and Raftery (1995).
constexpr double kStrongEvidence = 6.0;

class Identifying {
 public:
  Identifying(const BaseModel& base_model, const event::Progress& report)
      : base_model_(base_model),
        report_(report),
        polish_(base_model),
        none_(fit::penalised(base_model.fit)) {}

  std::vector<Judgement> run(std::vector<Hypothesis> all, const std::function<double(double)>& fit_others) {
    for (Hypothesis& h : all) {
      reduced::Trial trial = trial_of(base_model_, h);
      tried_.push_back({std::move(h), std::move(trial)});
    }
    begin();
    identify();
    Identified* leader = worth_a_fit() ? fitted_leader() : nullptr;
    others_ = fit_others(least_fitted());
    if (!leader) return judgements();
    for (int point = 0; leader && !other_is_free(side_of(*leader)) && point < kLinearPoints; ++point) {
      fit({leader});
      if (!leader->best() || !linearise_about(*leader)) break;
      // About the second leader, which fits about as well, the optima found so far suffice as starts.
      identify(point == 0 ? reduced::IdentifyOptions{} : reduced::IdentifyOptions{.draws = 0, .kept = 0});
      fit_in_reach();
      if (leader == std::exchange(leader, best_fitted())) break;
    }
    fit_in_reach();
    find_companions();
    return judgements();
  }

 private:
  /// Reduced plant on which the blocks of one side are identified; null: the hypotheses of this side are
  /// skipped.
  using Reduced = Polish::Reduced;

  /// Prepares the reduced plants. If the reduced chi-square of the base model is below noise.measurable, the
  /// plant is linearised about its fit, and a side whose free input has little evidence is skipped. Otherwise
  /// the inputs are inferred.
  void begin() {
    if (base_model_.fit.reduced_chi2() >= thresholds::noise.measurable) return infer();
    const std::vector<event::EventState> states = states_of(base_model_.fit.events);
    for (const InputKind kind : {InputKind::torque, InputKind::field}) {
      if (!(free_input(kind)->evidence > kStrongEvidence)) continue;
      const auto side = std::make_shared<const reduced::Reduction>(
          reduced::linear_about(base_model_.fit.plant, base_model_.under_test(), base_model_.events,
                                polish_.free(), states, Polish::only(kind), base_model_.threads),
          base_model_.events, base_model_.conventions);
      none_ = reduced::ReducedPlant(*side, kind)
                  .costs(Eigen::VectorXd::Zero(side->knots()), Eigen::VectorXd::Zero(1))[0];
      (kind == InputKind::torque ? torque_ : field_) = side;
    }
  }
  /// Returns the base model's known inferred input, or infers it.
  [[nodiscard]] std::shared_ptr<const reduced::FreeInput> free_input(InputKind kind) const {
    const reduced::FreeInput* known = kind == InputKind::torque ? base_model_.torque : base_model_.field;
    if (known) return {std::shared_ptr<void>(), known};
    return std::make_shared<const reduced::FreeInput>(
        reduced::free_input(kind, base_model_.under_test(), base_model_.events, polish_.free(),
                            base_model_.fit, base_model_.threads));
  }
  /// Infers the torque alone, the field voltage alone, and both together. Their evidence decides whether one
  /// input suffices.
  void infer() {
    constexpr std::array kInputs = {reduced::Inputs{true, false}, reduced::Inputs{false, true},
                                    reduced::Inputs{true, true}};
    std::array<std::shared_ptr<const reduced::Inference>, kInputs.size()> found;
    in_parallel(
        kInputs.size(),
        [&](std::size_t i) {
          const reduced::FreeInput* known = i == 0   ? base_model_.torque
                                            : i == 1 ? base_model_.field
                                                     : nullptr;
          found[i] = known && known->inference
                         ? known->inference
                         : std::make_shared<const reduced::Inference>(reduced::infer(
                               base_model_.under_test(), base_model_.events, polish_.free(), kInputs[i], 1));
        },
        [&](int done) {
          if (report_) report_(event::Phase::missing_input, "", done, kInputs.size());
        },
        base_model_.threads);
    if (found[2]->criterion < std::min(found[0]->criterion, found[1]->criterion)) return reduce(*found[2]);
    // The better input is used. The other input is used too if its reduction of chi2 is at most
    // evidence.within_reach lower, or is more than search.fair times that of the better input.
    const auto takes_off = [&](std::size_t i) { return fit::penalised(base_model_.fit) - found[i]->chi2; };
    for (const std::size_t i : {0, 1})
      if (found[i]->criterion < found[1 - i]->criterion ||
          takes_off(i) > takes_off(1 - i) - thresholds::evidence.within_reach ||
          takes_off(i) > thresholds::search.fair * takes_off(1 - i))
        reduce(*found[i]);
  }
  void reduce(const reduced::Inference& found) {
    const auto reduction =
        std::make_shared<const reduced::Reduction>(found, base_model_.events, base_model_.conventions);
    if (found.inputs.torque) torque_ = reduction;
    if (found.inputs.field) field_ = reduction;
  }
  [[nodiscard]] const Reduced& side_of(const Identified& h) const {
    return h.input() == InputKind::torque ? torque_ : field_;
  }
  /// Returns whether the records need both inputs, which means that an effect is missing on each side.
  static bool other_is_free(const Reduced& side) {
    return side->inference().inputs.torque && side->inference().inputs.field;
  }
  void identify(const reduced::IdentifyOptions& options = {}) {
    const double reach = highest_cost();
    std::vector<Identified*> all;
    for (Identified& h : tried_) all.push_back(&h);
    each(all, base_model_.with.empty() ? event::Phase::quick_fits : event::Phase::second_quick_fits,
         [&](Identified& h) {
           if (!(h.cost > reach)) identify(h, options);
         });
  }
  /// Returns the cost above which a hypothesis cannot become the best; infinite before the first
  /// identification. The linearisation about another block predicts the gain of a block with many parameters
  /// with an error of up to search.near.
  [[nodiscard]] double highest_cost() {
    const Identified* leader = least();
    if (!leader) return std::numeric_limits<double>::infinity();
    return leader->cost + std::max<double>(thresholds::evidence.within_reach,
                                           thresholds::search.near * (none_ - leader->cost));
  }
  void identify(Identified& h, const reduced::IdentifyOptions& options) const {
    const Reduced& side = side_of(h);
    if (!side) return;
    std::vector<std::vector<double>> known;
    for (const reduced::Optimum& o : h.optima) known.push_back(o.values);
    const bool first = known.empty();
    if (first) known = h.hypothesis.further;
    if (const fit::Fit* best = h.best()) known.push_back(fit::values_of(best->plant, h.trial.free));
    h.optima = reduced::identify(*side, h.input(), h.trial, options, known);
    h.optima.resize(std::min(h.optima.size(), kOptima));
    h.cost = h.optima.empty() ? std::numeric_limits<double>::infinity() : h.optima.front().cost;
  }
  [[nodiscard]] Identified* least() {
    const auto best = std::ranges::min_element(tried_, {}, &Identified::cost);
    return best == tried_.end() || !std::isfinite(best->cost) ? nullptr : &*best;
  }
  /// Returns whether the best hypothesis is predicted to reach half of the required evidence, and may be
  /// accepted.
  [[nodiscard]] bool worth_a_fit() {
    const Identified* best = least();
    return best && !cannot_be_accepted(base_model_, best->cost, none_) &&
           none_ - best->cost >
               (base_model_.with.empty() ? thresholds::evidence.accepted : thresholds::evidence.second) / 2;
  }
  /// Fits the leading hypotheses with the whole plant and returns the best; null if none can be fitted.
  [[nodiscard]] Identified* fitted_leader() {
    std::vector<Identified*> leading;
    for (Identified& h : tried_)
      if (std::isfinite(h.cost)) leading.push_back(&h);
    std::ranges::stable_sort(leading, {}, &Identified::cost);
    leading.resize(std::min(leading.size(), kLeading));
    each(leading, event::Phase::quick_fits, [&](Identified& h) { polish_.briefly(h, *side_of(h)); });
    return best_fitted();
  }
  [[nodiscard]] Identified* best_fitted() {
    Identified* best = nullptr;
    for (Identified& h : tried_)
      if (h.best() && (!best || fit::better(*h.best(), *best->best()))) best = &h;
    return best;
  }
  [[nodiscard]] double least_fitted() {
    const Identified* best = best_fitted();
    return best ? fit::penalised(*best->best()) : std::numeric_limits<double>::infinity();
  }
  /// Linearises the plant about the leader's fit, for the leader's side. Returns false if that plant cannot
  /// be simulated.
  [[nodiscard]] bool linearise_about(const Identified& leader) {
    Reduced& side = leader.input() == InputKind::torque ? torque_ : field_;
    try {
      side = polish_.linear_about(leader);
    } catch (const InputError&) {
      return false;
    }
    return true;
  }
  /// Finds companions on the plant linearised about the leader's fit. Does nothing if an effect was added
  /// before, if another hypothesis fits better, or if this plant cannot be linearised.
  void find_companions() {
    const Identified* leader = best_fitted();
    if (!leader || !base_model_.with.empty() || base_model_.stopped() || others_ < leader->cost) return;
    try {
      hypothesis::find_companions(base_model_, polish_, *leader, tried_);
    } catch (const InputError&) {  // integration with sensitivities takes other steps and may fail
    }
  }
  /// Fits the hypotheses that may come within reach of the best.
  void fit_in_reach() {
    const double reach = highest_cost();
    std::vector<Identified*> some;
    for (Identified& h : tried_) {
      if (h.cost < reach)
        some.push_back(&h);
      else if (!h.polished)
        h.fits.clear();
    }
    fit(some);
  }
  /// Fits the hypotheses whose fits are not complete. The goal of a block's fit depends on `others_` only if
  /// the block's identified cost is higher than `others_`. A tighter goal might end a slowly converging fit
  /// too early.
  void fit(std::vector<Identified*> some) {
    std::erase_if(some, [](const Identified* h) { return h->polished; });
    const double least = least_fitted();
    each(some, event::Phase::full_fits, [&](Identified& h) {
      const Reduced& side = side_of(h);
      const double goal =
          (h.cost < others_ ? least : std::min(others_, least)) + thresholds::evidence.within_reach;
      other_is_free(side) ? polish_.briefly(h, *side) : polish_.polish(h, *side, goal);
      h.polished = true;
      if (!h.best() || other_is_free(side)) return;  // polish() has set the cost of an abandoned fit
      h.cost = fit::penalised(*h.best());
      if (!(h.cost < goal)) h.fits.clear();
    });
  }
  [[nodiscard]] std::vector<Judgement> judgements() {
    std::vector<Judgement> all;
    const Identified* leader = nullptr;  // best of the fitted hypotheses
    for (const Identified& h : tried_)
      if (h.best() && (!leader || h.cost < leader->cost)) leader = &h;
    for (const Identified& h : tried_) {
      const bool other_side = !side_of(h);
      const char* input = h.input() == InputKind::torque ? "torque" : "field voltage";
      if (!std::isfinite(h.cost) && !other_side) continue;
      Judgement j;
      j.hypothesis = h.hypothesis;
      bring(base_model_, j.hypothesis);
      j.hypothesis.plant = h.trial.plant;
      j.companion = h.companion;
      j.companion_gain = h.companion_gain;
      if (const fit::Fit* f = h.best()) {
        j.fit = std::isfinite(fit::criterion(*f)) ? *f : with_errors(base_model_, j.hypothesis, *f);
        j.gain = fit::gain(base_model_.fit, j.fit,
                           std::isfinite(fit::criterion(j.fit)) ? fit::criterion : fit::penalised);
      } else {
        j.fit = base_model_.fit;
        j.fitted = false;
        if (other_side) {
          j.why_not = fmt::format("not fitted: even an arbitrary {} reduces the residual too little", input);
        } else if (leader && h.cost <= leader->cost) {
          j.why_not = "not fitted: the whole plant cannot be simulated with its preliminary fit";
        } else if (leader) {
          j.behind = h.cost - leader->cost;
          j.why_not = fmt::format(
              "not fitted: the chi-square of its preliminary fit to the inferred {} is higher by {:.0f} "
              "than that of {}",
              input, j.behind, leader->hypothesis.name);
        } else {
          j.gain = none_ - h.cost;
          j.why_not = too_small(j.gain);
        }
      }
      all.push_back(std::move(j));
    }
    place_unfitted(all);
    std::ranges::stable_sort(all, std::greater<>(), &Judgement::gain);
    return all;
  }
  template <class F>
  void each(const std::vector<Identified*>& some, event::Phase phase, F act) const {
    for_each_hypothesis(
        base_model_, report_, phase, some.size(), [&](std::size_t k) { return some[k]->hypothesis.name; },
        [&](std::size_t k) { act(*some[k]); });
  }

  const BaseModel& base_model_;
  const event::Progress& report_;
  Polish polish_;
  std::vector<Identified> tried_;
  Reduced torque_, field_;
  double none_;  ///< cost of the base model
  /// Lowest cost among the fits made to find the leader and those of hypotheses that cannot be identified
  /// without the rest of the plant.
  double others_ = std::numeric_limits<double>::infinity();
};

}  // namespace

void place_unfitted(std::vector<Judgement>& all) {
  double best = 0;
  for (const Judgement& j : all)
    if (j.fitted) best = std::max(best, j.gain);
  for (Judgement& j : all)
    if (j.behind > 0) j.gain = best - j.behind;
}

bool can_be_identified(const BaseModel& base_model, const Hypothesis& h) {
  return base_model.component() == record::Component::plant && !base_model.plant.machine.effect->converter &&
         (h.side == Side::mechanical || h.side == Side::excitation) && !h.free.empty() &&
         h.conventions.speed_voltage == base_model.conventions.speed_voltage &&
         std::ranges::none_of(base_model.events, [](const event::FitEvent& e) {
           return e.record.breaker() != nullptr || e.record.open_circuit() || !e.record.staged.empty();
         });
}

std::vector<Judgement> identified(const BaseModel& base_model, std::vector<Hypothesis> all,
                                  const std::function<double(double least)>& fit_others,
                                  const event::Progress& report) {
  return Identifying(base_model, report).run(std::move(all), fit_others);
}

}  // namespace swingbank::validate::hypothesis
