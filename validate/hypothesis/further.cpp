// Rivals and pairs fitted once more from further starts, with the machine as the leading hypothesis found it.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <ranges>

#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// Runs of one answer that took other steps leave the same up to this share.
constexpr double kSameRun = 1e-5;

/// Copies the values of the `free` parameters of `like` from one plant to another, where both have them.
void copy_values(const sim::plant::Plant& from, const sim::plant::Plant& like,
                 const std::vector<fit::FreeParameter>& free, sim::plant::Plant& to) {
  for (const fit::FreeParameter& f : free) {
    const auto source = sim::plant::same_parameter(from, like, f.id),
               target = sim::plant::same_parameter(to, like, f.id);
    if (source && target)
      sim::plant::parameter_value(to, *target) = sim::plant::parameter_value(from, *source);
  }
}

/// The second effect of a fit that stays, at the values that it has there.
Judgement staying(const Hypothesis& h, const fit::Fit& in) {
  Judgement stays;
  stays.hypothesis = h;
  stays.fit.plant = h.plant;
  copy_values(in.plant, h.plant, h.free, stays.fit.plant);
  return stays;
}
/// `h` beside what the stage holds, not fitted: everything starts as in `from`, but what the stage brings.
Judgement begun(const Stage& then, Hypothesis h, const fit::Fit& from) {
  Judgement j;
  j.fit.failed = "not fitted";
  j.fit.plant = h.plant;
  copy_values(from.plant, h.plant, free_of(h, then.spread), j.fit.plant);
  copy_values(then.fit.plant, then.plant, then.own, j.fit.plant);
  for (const auto& e : from.events) j.fit.events.emplace_back().state = e.state;
  bring(then, h);
  j.hypothesis = std::move(h);
  return j;
}

}  // namespace

std::vector<double> by_name(const Hypothesis& h, std::vector<double> values,
                            const sim::plant::Plant& leader) {
  int there = 0;
  while (there < sim::plant::block_count(leader) &&
         static_cast<int>(sim::plant::block_effect(leader, there).slot) != h.slot)
    ++there;
  if (there == sim::plant::block_count(leader)) return values;
  const auto& known = sim::plant::block_effect(leader, there).parameters;
  for (std::size_t i = 0; i < h.free.size(); ++i) {
    const fit::FreeParameter& f = h.free[i];
    if (static_cast<int>(sim::plant::block_effect(h.plant, f.id.block).slot) != h.slot) continue;
    const sim::Parameter& own = sim::plant::parameter_record(h.plant, f.id);
    const auto same = std::ranges::find_if(
        known, [&](const sim::Parameter& p) { return p.name == own.name && p.unit == own.unit; });
    if (same == known.end()) continue;
    const double value = sim::plant::parameter_value(leader, {there, static_cast<int>(same - known.begin())});
    values[i] = std::clamp(value, own.low, own.high);
  }
  return values;
}

bool alike(double left, double other) {
  return std::abs(left - other) <
         std::max(thresholds::search.other_steps.value, kSameRun * std::min(left, other));
}

double left_by(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
               const std::vector<fit::EventState>& states) {
  double chi2 = 0;
  try {
    for (std::size_t e = 0; e < events.size(); ++e) {
      fit::EventFit f;
      fit::compare(events, e, event::play(tested, events[e], states[e]), f);
      chi2 += f.chi2;
    }
  } catch (const InputError&) {
    return std::numeric_limits<double>::infinity();
  }
  return chi2;
}

std::vector<double> left_by_each(std::span<const sim::plant::Plant> plants,
                                 const sim::Conventions& conventions, const event::WhitenedEvents& events,
                                 const std::vector<fit::EventState>& states) {
  std::vector<double> left(plants.size(), 0.0);
  for (std::size_t e = 0; e < events.size(); ++e) {
    const auto answers = event::play_together(plants, conventions, events[e], states[e], {.lenient = true});
    for (std::size_t k = 0; k < plants.size(); ++k) {
      fit::EventFit f;
      if (answers[k]) fit::compare(events, e, *answers[k], f);
      left[k] += answers[k] ? f.chi2 : std::numeric_limits<double>::infinity();
    }
  }
  return left;
}

void try_further(const Stage& stage, const fit::Fit& leader, Judgement& j) {
  constexpr std::size_t kFurther = 2;
  constexpr int kOwnSteps = 8, kBriefSteps = 4, kAllSteps = 6;
  const Hypothesis& h = j.hypothesis;
  // where nothing but noise is left, it is near enough: what remains to be found is try_basins' to find
  if (j.fit.failed.empty() && j.fit.misfit() < thresholds::adequacy.misfit &&
      fit::gain(j.fit, leader) < thresholds::evidence.accepted)
    return;
  // parameters that both share start at the leader's values
  Hypothesis led = h;
  for (const auto& p : leader.parameters) {
    const auto id = sim::plant::same_parameter(led.plant, leader.plant, p.where.id);
    if (id && sim::plant::same_parameter(stage.plant, leader.plant, p.where.id))
      sim::plant::parameter_value(led.plant, *id) = p.value;
  }
  std::vector<fit::EventState> states;
  for (const auto& e : leader.events) states.push_back(e.state);
  auto starts = h.starts;
  starts.push_back(fit::values_of(j.fit.plant, h.free));
  starts.push_back(by_name(h, starts.back(), leader.plant));
  std::vector<std::pair<double, const std::vector<double>*>> order;
  std::vector<sim::plant::Plant> plants;
  for (const auto& start : starts) plants.push_back(started(led, start));
  const auto left = left_by_each(plants, h.conventions, stage.events, states);
  for (std::size_t k = 0; k < starts.size(); ++k)
    if (std::isfinite(left[k])) order.emplace_back(left[k], &starts[k]);
  std::ranges::sort(order);
  const auto same = [](const auto& a, const auto& b) { return alike(a.first, b.first); };
  order.erase(std::unique(order.begin(), order.end(), same), order.end());
  const auto free = free_of(h, stage.spread);
  for (std::size_t k = 0; k < std::min(kFurther, order.size()); ++k) {
    fit::FitOptions o{.lenient = true, .errors = false};
    o.start = states;
    o.iterations = kOwnSteps;
    o.values = *order[k].second;
    const fit::Fit own = fit::fit({led.plant, h.conventions}, stage.events, h.free, o);
    if (!own.failed.empty()) continue;
    o = fit::continued(o, own, free);
    o.iterations = kBriefSteps;
    const fit::Fit brief = fit::fit(h.under_test(), stage.events, free, o);
    const double behind = fit::gain(brief, j.fit);
    if (!brief.failed.empty() || (behind > thresholds::evidence.within_reach &&
                                  behind > thresholds::search.coming * fit::gain(own, j.fit)))
      continue;
    o = fit::continued(o, brief, free);
    o.iterations = kAllSteps;
    const fit::Fit f = fit::fit(h.under_test(), stage.events, free, o);
    if (!f.failed.empty() || !fit::better(f, j.fit)) continue;
    if (auto known = with_errors(stage, h, f)) j.fit = std::move(*known);
  }
}

std::optional<fit::Fit> with_errors(const Stage& stage, const Hypothesis& h, const fit::Fit& f) {
  const auto free = free_of(h, stage.spread);
  fit::Fit known = fit::fit(h.under_test(), stage.events, free,
                            fit::continued({.iterations = 0, .lenient = true}, f, free));
  if (!known.failed.empty()) return std::nullopt;
  return known;
}

void fit_on(const Stage& stage, Judgement& j) {
  constexpr int kRoundSteps = 6, kRounds = 5;
  if (!j.fit.failed.empty()) return;
  const auto free = free_of(j.hypothesis, stage.spread);
  const fit::Fit begin = j.fit;
  fit::FitOptions o{.lenient = true, .errors = false};
  o.iterations = kRoundSteps;
  for (int round = 0; round < kRounds; ++round) {
    fit::Fit f = fit::fit(j.hypothesis.under_test(), stage.events, free, fit::continued(o, j.fit, free));
    if (!f.failed.empty() || !fit::better(f, j.fit)) break;
    const double gained = fit::gain(j.fit, f);
    j.fit = std::move(f);
    if (j.fit.converged || gained < thresholds::search.worth_a_round) break;
  }
  auto known = with_errors(stage, j.hypothesis, j.fit);
  j.fit = known && fit::gain(begin, *known, fit::criterion) > 0 ? std::move(*known) : begin;
}

void try_begun(const Stage& stage, Judgement& j) {
  const auto free = free_of(j.hypothesis, stage.spread);
  if (fit::Fit f = fit::fit(j.hypothesis.under_test(), stage.events, free,
                            fit::continued({.lenient = true}, j.fit, free));
      f.failed.empty())
    j.fit = std::move(f);
}

void try_exchange(const Stage& stage, const Judgement& pair, Judgement& j) {
  try_begun(stage, j);
  if (fit::gain(j.fit, pair.fit) > thresholds::search.exchange_behind) try_further(stage, pair.fit, j);
}

void try_from(const Stage& stage, const fit::Fit& other, Judgement& j) {
  const Hypothesis& h = j.hypothesis;
  const auto free = free_of(h, stage.spread);
  fit::FitOptions o{.lenient = true};
  for (const fit::FreeParameter& f : free) {
    const auto id = sim::plant::same_parameter(other.plant, h.plant, f.id);
    o.values.push_back(id ? sim::plant::parameter_value(other.plant, *id)
                          : sim::plant::parameter_value(j.fit.plant, f.id));
  }
  for (const auto& e : other.events) o.start.push_back(e.state);
  if (fit::Fit f = fit::fit(h.under_test(), stage.events, free, o); f.failed.empty() && fit::better(f, j.fit))
    j.fit = std::move(f);
}

Stage after(const Stage& stage, const Judgement& j) {
  return {stage.events, j.hypothesis.plant, j.hypothesis.conventions, stage.library,
          j.fit,        j.hypothesis.free,  j.hypothesis.name,        stage.spread,
          stage.threads};
}

void bring(const Stage& stage, Hypothesis& h) {
  h.with = stage.with;
  for (const fit::FreeParameter& f : stage.own) {
    h.free.push_back({sim::plant::same_parameter(h.plant, stage.plant, f.id).value(), f.spread});
    const double value = sim::plant::parameter_value(stage.fit.plant, f.id);
    for (auto& start : h.starts) start.push_back(value);
  }
}

std::vector<Judgement> exchanges(const Stage& stage, const Judgement& pair,
                                 const std::vector<Judgement>& alone) {
  const auto all = all_hypotheses(stage.under_test(), stage.library, stage.component());
  const auto first = std::ranges::find(all, pair.hypothesis.with, &Hypothesis::name),
             second = std::ranges::find(all, pair.hypothesis.name, &Hypothesis::name);
  if (first == all.end() || second == all.end()) return {};  // one effect needs the other to be there
  const Judgement stays = staying(*second, pair.fit);
  const Stage then = after(stage, stays);
  std::vector<Judgement> rivals;
  for (Hypothesis& h : all_hypotheses(then.under_test(), then.library, then.component())) {
    const auto known = std::ranges::find(alone, h.name, [](const Judgement& j) { return j.hypothesis.name; });
    const bool in_slot = first->slot >= 0 && h.slot == first->slot;
    const bool holds = known != alone.end() && known->accepted && known->hypothesis.with.empty();
    if (h.name == first->name || h.name == second->name || !(in_slot || holds)) continue;
    const bool found = known != alone.end() && known->fitted;
    rivals.push_back(begun(then, std::move(h), found ? known->fit : pair.fit));
  }
  return rivals;
}

Judgement crossed(const Stage& stage, const Cross& cross) {
  Judgement none;
  none.hypothesis.with = cross.stays;
  none.hypothesis.name = cross.joins;
  none.fit.failed = "one of its effects needs another to be there";
  const auto named = [](std::vector<Hypothesis> all, const std::string& name) {
    std::erase_if(all, [&](const Hypothesis& h) { return h.name != name; });
    return all;
  };
  const auto first = named(all_hypotheses(stage.under_test(), stage.library, stage.component()), cross.stays);
  if (first.empty()) return none;
  const Judgement stays = staying(first.front(), cross.stays_in->fit);
  const Stage then = after(stage, stays);
  auto second = named(all_hypotheses(then.under_test(), then.library, then.component()), cross.joins);
  return second.empty() ? none : begun(then, std::move(second.front()), cross.joins_in->fit);
}

std::optional<Cross> best_cross(std::span<const Judgement> pairs) {
  const auto known = [&](const std::string& x, const std::string& y) -> const Judgement* {
    for (const Judgement& j : pairs)
      if ((j.hypothesis.with == x && j.hypothesis.name == y) ||
          (j.hypothesis.with == y && j.hypothesis.name == x))
        return &j;
    return nullptr;
  };
  const auto found = [](const Judgement& j) { return j.fit.failed.empty(); };
  const auto both = [](const Judgement& j) { return std::array{&j.hypothesis.with, &j.hypothesis.name}; };
  std::optional<Cross> best;
  for (const Judgement& one : pairs | std::views::filter(found))
    for (const Judgement& other : pairs | std::views::filter(found))
      for (const std::size_t i : {0, 1})
        for (const std::size_t k : {0, 1}) {
          const std::string &joins = *both(one)[i], &stays = *both(other)[k];
          const Judgement* between = known(*both(one)[1 - i], *both(other)[1 - k]);
          const bool three = between && between != &one && between != &other && found(*between);
          if (!three || one.gain < other.gain || joins == stays || known(joins, stays)) continue;
          const double expected = one.gain + other.gain - between->gain;
          if (!best || expected > best->expected) best = {joins, &one, stays, &other, expected};
        }
  return best;
}

}  // namespace swingbank::validate::hypothesis
