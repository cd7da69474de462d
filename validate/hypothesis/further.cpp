// Hypotheses fitted once more from further starts, with the machine as the leading hypothesis found it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// Runs of one answer that took other steps leave the same up to this share.
constexpr double kSameRun = 1e-5;

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

void fit_alone(const Stage& stage, Judgement& j) {
  const auto free = free_of(j.hypothesis, stage.spread);
  fit::FitOptions o{.lenient = true};
  for (const auto& e : stage.fit.events) o.start.push_back(e.state);
  j.fit = fit::fit(j.hypothesis.under_test(), stage.events, free, o);
  j.fitted = j.fit.failed.empty();
  if (j.fitted) j.gain = fit::gain(stage.fit, j.fit, fit::criterion);
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

}  // namespace swingbank::validate::hypothesis
