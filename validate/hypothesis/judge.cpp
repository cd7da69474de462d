#include "validate/hypothesis/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace swingbank::validate::hypothesis {

std::pair<double, double> mean_reduced_chi2(const std::vector<HeldOut>& held_out) {
  double before = 0, after = 0;
  for (const HeldOut& h : held_out) {
    before += h.before / static_cast<double>(held_out.size());
    after += h.after / static_cast<double>(held_out.size());
  }
  return {before, after};
}

std::vector<fit::FreeParameter> free_of(const Hypothesis& h, double prior_sd) {
  std::vector<fit::FreeParameter> free;
  for (const auto& f : fit::free_parameters(h.plant, prior_sd))
    if (std::ranges::none_of(h.free, [&](const fit::FreeParameter& own) { return own.id == f.id; }))
      free.push_back(f);
  free.insert(free.end(), h.free.begin(), h.free.end());
  return free;
}

std::vector<HeldOut> hold_out(const Trial& trial, const sim::plant::PlantUnderTest& tested,
                              const std::vector<fit::FreeParameter>& free, const fit::Fit& whole) {
  std::vector<HeldOut> out(trial.events.size());
  for (std::size_t left = 0; left < trial.events.size(); ++left) {
    const noise::WhitenedEvents others = trial.events.without(left);
    fit::FitOptions o;
    o.iterations = 1;  // from the fit to all events, one Gauss-Newton step suffices
    o.errors = false;
    o.lenient = true;
    for (std::size_t e = 0; e < trial.events.size(); ++e)
      if (e != left) o.start.push_back(whole.events[e].state);
    out[left].record = trial.events[left].record.name;
    out[left].values = trial.events[left].values();
    if (others.empty()) continue;
    const auto& all = free.empty() ? fit::free_parameters(tested.plant, trial.prior_sd) : free;
    o.values = fit::values_of(whole.plant, all);
    const fit::Fit seen = fit::fit(tested, others, all, o);
    const fit::Fit f = fit::fit({seen.failed.empty() ? seen.plant : tested.plant, tested.conventions},
                                trial.events.alone(left), {}, {.start = {whole.events[left].state}});
    out[left].after = f.failed.empty() ? f.reduced_chi2() : 1e300;
    out[left].cost_after = seen.failed.empty() ? fit::gain(whole, seen) / whole.events[left].values
                                               : std::numeric_limits<double>::infinity();
  }
  return out;
}

std::string objection(const std::vector<HeldOut>& held_out, double evidence, double adequate) {
  for (const HeldOut& h : held_out)
    if ((h.cost_after > thresholds::held_out.worse * h.cost_before && h.cost_after > adequate) ||
        h.saves() < -std::max(thresholds::held_out.costs.value, thresholds::held_out.costs_share * evidence))
      return fmt::format("increases the error of held-out {}", h.record);
  for (const HeldOut& h : held_out)
    if (h.cost_after > thresholds::held_out.predicts &&
        h.cost_after > thresholds::held_out.falls * h.cost_before)
      return fmt::format("does not predict held-out {}", h.record);
  return "";
}

void judge(const Trial& trial, const fit::Fit& base, const std::vector<HeldOut>& held_out_base,
           Judgement& j) {
  if (!j.fitted) return;
  j.why_not.clear();
  const auto free = free_of(j.hypothesis, trial.prior_sd);
  if (fit::Fit f = fit::fit(j.hypothesis.under_test(), trial.events, free,
                            fit::continued({.lenient = true}, j.fit, free));
      f.failed.empty() && fit::gain(j.fit, f) > -thresholds::evidence.same_fit)
    j.fit = std::move(f);
  fit::correct_noise_transfer(trial.noise_transfer, j.hypothesis.conventions, j.fit);
  j.gain = fit::gain(base, j.fit, fit::criterion);
  j.size = std::sqrt(std::max(0.0, fit::gain(base, j.fit, fit::data_cost)));
  if (j.gain < trial.evidence) {
    j.why_not = fmt::format("evidence {:.0f}, below {:.0f}", j.gain, trial.evidence);
    return;
  }
  j.held_out = hold_out(trial, j.hypothesis.under_test(), free, j.fit);
  for (std::size_t e = 0; e < j.held_out.size(); ++e) {
    j.held_out[e].before = held_out_base[e].after;
    j.held_out[e].cost_before = held_out_base[e].cost_after;
  }
  j.why_not = objection(j.held_out, j.gain, trial.adequate);
  if (!j.why_not.empty()) return;
  if (j.fit.reduced_chi2() > trial.adequate) {
    j.why_not = fmt::format("reduced chi-square {:.2f}, above {:.2f}: the residual exceeds noise",
                            j.fit.reduced_chi2(), trial.adequate);
    return;
  }
  j.accepted = true;
}

}  // namespace swingbank::validate::hypothesis
