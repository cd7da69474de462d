#include <algorithm>
#include <cmath>
#include <limits>

#include "validate/instruments.hpp"
#include "validate/search.hpp"

namespace swingbank::validate {
namespace {

/// Copies the values of the `free` parameters of `like` from one plant to another, where both have them.
void copy_values(const sim::Plant& from, const sim::Plant& like, const std::vector<FreeParameter>& free,
                 sim::Plant& to) {
  for (const FreeParameter& f : free) {
    const sim::Effect& effect = block_effect(like, f.block);
    const int source = find_block(from, effect), target = find_block(to, effect);
    if (source >= 0 && target >= 0)
      parameter_value(to, target, f.index) = parameter_value(from, source, f.index);
  }
}

/// Returns `values` of the hypothesis's free parameters, but takes those of its slot from the leader's effect
/// there wherever that has a parameter of the same name and unit. Effects of one slot share the names of
/// their textbooks.
std::vector<double> by_name(const Hypothesis& h, std::vector<double> values, const sim::Plant& leader) {
  int there = 0;
  while (there < block_count(leader) && static_cast<int>(block_effect(leader, there).slot) != h.slot) ++there;
  if (there == block_count(leader)) return values;
  const auto& known = block_effect(leader, there).parameters;
  for (std::size_t i = 0; i < h.free.size(); ++i) {
    const FreeParameter& f = h.free[i];
    if (static_cast<int>(block_effect(h.plant, f.block).slot) != h.slot) continue;
    const sim::Parameter& own = parameter_record(h.plant, f.block, f.index);
    const auto same = std::ranges::find_if(
        known, [&](const sim::Parameter& p) { return p.name == own.name && p.unit == own.unit; });
    if (same == known.end()) continue;
    const double value = parameter_value(leader, there, static_cast<int>(same - known.begin()));
    values[i] = std::clamp(value, own.low, own.high);
  }
  return values;
}

}  // namespace

double left_by(const sim::Plant& plant, const sim::Conventions& conventions,
               const std::vector<FitEvent>& events, const std::vector<EventState>& states) {
  double chi2 = 0;
  try {
    for (std::size_t e = 0; e < events.size(); ++e) {
      const VoltageCurve curve(events[e].played(), switchings_at(events[e], states[e]));
      Drive run = drive_at(plant, conventions, events[e], states[e]);
      run.curve = &curve;
      EventFit f;
      compare(events[e], observe(run), f);
      chi2 += f.chi2;
    }
  } catch (const InputError&) {
    return std::numeric_limits<double>::infinity();
  }
  return chi2;
}

void try_further(const Stage& stage, const Fit& leader, Judgement& j) {
  constexpr std::size_t kFurther = 2;
  constexpr int kOwnSteps = 8, kAllSteps = 10;
  const Hypothesis& h = j.hypothesis;
  // parameters that both share start at the leader's values
  Hypothesis led = h;
  for (const auto& p : leader.parameters) {
    const sim::Effect& effect = block_effect(leader.plant, p.where.block);
    const int block = find_block(led.plant, effect);
    if (block >= 0 && find_block(stage.plant, effect) >= 0)
      parameter_value(led.plant, block, p.where.index) = p.value;
  }
  std::vector<EventState> states;
  for (const auto& e : leader.events) states.push_back(e.state);
  auto starts = h.starts;
  starts.push_back(values_of(j.fit.plant, h.free));
  starts.push_back(by_name(h, starts.back(), leader.plant));
  std::vector<std::pair<double, const std::vector<double>*>> order;
  for (const auto& start : starts)
    if (const double left = left_by(started(led, start), h.conventions, stage.events, states);
        std::isfinite(left))
      order.emplace_back(left, &start);
  std::ranges::sort(order);
  const auto free = free_of(h, stage.spread);
  for (std::size_t k = 0; k < std::min(kFurther, order.size()); ++k) {
    FitOptions o;
    o.errors = false;
    o.start = states;
    o.iterations = kOwnSteps;
    o.values = *order[k].second;
    const Fit own = fit(led.plant, h.conventions, stage.events, h.free, o);
    if (!own.failed.empty()) continue;
    o = continued(o, own, free);
    o.errors = true;
    o.iterations = kAllSteps;
    if (Fit f = fit(h.plant, h.conventions, stage.events, free, o);
        f.failed.empty() && penalised(f) < penalised(j.fit))
      j.fit = std::move(f);
  }
}

void try_exchange(const Stage& stage, const Judgement& pair, Judgement& j) {
  constexpr double kBehind = 10;
  const auto free = free_of(j.hypothesis, stage.spread);
  if (Fit f =
          fit(j.hypothesis.plant, j.hypothesis.conventions, stage.events, free, continued({}, j.fit, free));
      f.failed.empty())
    j.fit = std::move(f);
  if (penalised(j.fit) > penalised(pair.fit) + kBehind) try_further(stage, pair.fit, j);
}

void try_from(const Stage& stage, const Fit& other, Judgement& j) {
  const Hypothesis& h = j.hypothesis;
  const auto free = free_of(h, stage.spread);
  FitOptions o;
  for (const FreeParameter& f : free) {
    const int block = find_block(other.plant, block_effect(h.plant, f.block));
    o.values.push_back(block >= 0 ? parameter_value(other.plant, block, f.index)
                                  : parameter_value(j.fit.plant, f.block, f.index));
  }
  for (const auto& e : other.events) o.start.push_back(e.state);
  if (Fit f = fit(h.plant, h.conventions, stage.events, free, o);
      f.failed.empty() && penalised(f) < penalised(j.fit))
    j.fit = std::move(f);
}

Stage after(const Stage& stage, const Judgement& j) {
  return {stage.events, j.hypothesis.plant, j.hypothesis.conventions,
          j.fit,        j.hypothesis.free,  j.hypothesis.name,
          stage.spread, stage.threads};
}

void bring(const Stage& stage, Hypothesis& h) {
  h.with = stage.with;
  for (const FreeParameter& f : stage.own) {
    const int block = find_block(h.plant, block_effect(stage.plant, f.block));
    h.free.push_back({block, f.index, f.spread});
    const double value = parameter_value(stage.fit.plant, f.block, f.index);
    for (auto& start : h.starts) start.push_back(value);
  }
}

std::vector<Judgement> exchanges(const Stage& stage, const Judgement& pair,
                                 const std::vector<Judgement>& alone) {
  const auto all = all_hypotheses(stage.plant, stage.conventions);
  const auto first = std::ranges::find(all, pair.hypothesis.with, &Hypothesis::name),
             second = std::ranges::find(all, pair.hypothesis.name, &Hypothesis::name);
  if (first == all.end() || second == all.end()) return {};  // one effect needs the other to be there
  Judgement stays;
  stays.hypothesis = *second;
  stays.fit.plant = second->plant;
  copy_values(pair.fit.plant, second->plant, second->free, stays.fit.plant);
  const Stage then = after(stage, stays);
  std::vector<Judgement> rivals;
  for (Hypothesis& h : all_hypotheses(then.plant, then.conventions)) {
    const auto known = std::ranges::find(alone, h.name, [](const Judgement& j) { return j.hypothesis.name; });
    const bool in_slot = first->slot >= 0 && h.slot == first->slot;
    const bool holds = known != alone.end() && known->accepted && known->hypothesis.with.empty();
    if (h.name == first->name || h.name == second->name || !(in_slot || holds)) continue;
    const bool found = known != alone.end() && known->fitted;
    const Fit& from = found ? known->fit : pair.fit;
    Judgement j;
    j.fit.failed = "not fitted";
    j.fit.plant = h.plant;
    copy_values(from.plant, h.plant, free_of(h, stage.spread), j.fit.plant);
    copy_values(pair.fit.plant, then.plant, then.own, j.fit.plant);
    for (const auto& e : from.events) j.fit.events.emplace_back().state = e.state;
    bring(then, h);
    j.hypothesis = std::move(h);
    rivals.push_back(std::move(j));
  }
  return rivals;
}

}  // namespace swingbank::validate
