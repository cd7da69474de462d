#include <algorithm>
#include <cmath>
#include <limits>

#include "validate/instruments.hpp"
#include "validate/search.hpp"

namespace swingbank::validate {
namespace {

/// chi2 of a plant, the events where `states` have them; infinite where it cannot be run.
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

}  // namespace

void try_further(const Stage& stage, const Fit& leader, Judgement& j) {
  constexpr std::size_t kFurther = 2;
  constexpr int kOwnSteps = 8, kAllSteps = 10;
  const Hypothesis& h = j.hypothesis;
  // what both share, where the leader has it
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

}  // namespace swingbank::validate
