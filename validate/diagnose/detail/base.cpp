#include "validate/diagnose/detail/base.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/plant/usual.hpp"
#include "validate/noise/level.hpp"

namespace swingbank::validate::diagnose {
namespace {

/// Number of leading hypotheses from whose fits the given model is refitted.
constexpr std::size_t kWaysOut = 2;
/// Maximum number of fits for one noise estimate, if the fit has not converged but its residual is nearly
/// noise.
constexpr int kBaseRounds = 4;
/// Maximum number of noise estimates from the residuals of the given model, if these slightly exceed noise.
/// Noise of the voltage biases a fit, and a less biased fit gives another noise estimate.
constexpr int kMeasured = 3;

/// Returns whether further steps of the model's fit might reduce the residual to noise.
bool unfinished(const fit::Fit& f) {
  return f.failed.empty() && !f.converged && f.reduced_chi2() < thresholds::noise.believed;
}

fit::Fit from_extensions(const hypothesis::BaseModel& base_model,
                         const std::vector<hypothesis::Judgement>& ranked) {
  hypothesis::Judgement base;
  base.hypothesis = hypothesis::unchanged(base_model.under_test());
  base.fit = base_model.fit;
  for (std::size_t k = 0; k < std::min(kWaysOut, ranked.size()); ++k)
    if (ranked[k].fitted) hypothesis::try_from(base_model, ranked[k].fit, base);
  return std::move(base.fit);
}
/// Returns chi2 of each plant over all events, with the event states of `fits`; infinite if the simulation
/// fails. The plants differ only in parameter values and are simulated in SIMD batches.
std::vector<double> chi2_of_each(std::span<const sim::plant::Plant> plants,
                                 const sim::Conventions& conventions, const noise::WhitenedEvents& events,
                                 const std::vector<fit::EventFit>& fits) {
  std::vector<double> chi2(plants.size(), 0.0);
  for (std::size_t e = 0; e < events.size(); ++e) {
    const auto responses =
        event::play_together(plants, conventions, events[e], fits[e].state, {.lenient = true});
    for (std::size_t k = 0; k < plants.size(); ++k) {
      fit::EventFit f;
      if (responses[k]) noise::compare(events, e, *responses[k], f);
      chi2[k] += responses[k] ? f.chi2 : std::numeric_limits<double>::infinity();
    }
  }
  return chi2;
}

/// Refits the model after the best change of a single parameter. Such a change can correct a wrong limit that
/// is never reached. A fit alone does not change this limit, because the gradient with respect to it is zero.
fit::Fit from_another_value(const hypothesis::BaseModel& base_model) {
  constexpr std::array kMultiples = {0.3, 0.5, 0.7, 0.85, 1.2, 1.4, 2.0, 3.3};
  const auto free = fit::free_parameters(base_model.plant, base_model.prior_sd);
  std::vector<sim::plant::Plant> plants;
  for (const fit::FreeParameter& f : free)
    for (const double multiple : kMultiples) {
      plants.push_back(base_model.fit.plant);
      double& value = sim::plant::parameter_value(plants.back(), f.id);
      const auto range =
          sim::plant::search_range(sim::plant::parameter_record(base_model.plant, f.id), value);
      value = std::clamp(value * multiple, range.low, range.high);
    }
  const auto chi2 = chi2_of_each(plants, base_model.conventions, base_model.events, base_model.fit.events);
  const auto least = std::ranges::min_element(chi2);
  if (least == chi2.end() || !std::isfinite(*least)) return base_model.fit;
  fit::FitOptions o = fit::continued({.lenient = true}, base_model.fit, free);
  o.values = fit::values_of(plants[static_cast<std::size_t>(least - chi2.begin())], free);
  return fit::fit(base_model.under_test(), base_model.events, free, o);
}

}  // namespace

void require_fitted(const fit::Fit& base, const plant::PlantModel& model) {
  if (!base.failed.empty())
    throw InputError({"the model cannot be fitted", model.origin, base.failed,
                      "correct the model or leave the record out"});
}

void fit_base(const plant::PlantModel& model, const DiagnoseOptions& options, fit::FitOptions from,
              Diagnosis& d) {
  const auto free = fit::free_parameters(model.plant, options.prior_sd);
  d.base = fit::fit(model.under_test(), d.events, free, from);
  for (int measured = 0; d.base.failed.empty() && measured < kMeasured; ++measured) {
    d.events = d.events.with(noise::measure_noise_through({d.base.plant, model.conventions}, d.base.events,
                                                          d.base.reduced_chi2(), d.events));
    for (int round = 0; round == 0 || (round < kBaseRounds && unfinished(d.base)); ++round)
      d.base = fit::fit(model.under_test(), d.events, free, fit::continued({.lenient = true}, d.base, free));
    if (d.base.reduced_chi2() <= options.adequate || d.base.reduced_chi2() > thresholds::noise.believed)
      break;
  }
  require_fitted(d.base, model);
}

std::optional<fit::FitOptions> better_start(const hypothesis::BaseModel& base_model, const Diagnosis& d) {
  const auto from = [&](const fit::Fit& f) {
    return fit::continued({.lenient = true}, f, fit::free_parameters(base_model.plant, base_model.prior_sd));
  };
  const double leads = d.ranked.empty() ? 0.0 : std::max(0.0, d.ranked.front().gain);
  if (leads >= thresholds::evidence.accepted)
    if (const fit::Fit f = from_extensions(base_model, d.ranked);
        fit::gain(base_model.fit, f) > thresholds::evidence.escape * leads)
      return from(f);
  const double by_inputs = std::max(d.torque.evidence, d.field.evidence);
  if (by_inputs - leads < thresholds::evidence.accepted) return std::nullopt;
  if (const fit::Fit f = from_another_value(base_model);
      fit::gain(base_model.fit, f) - leads > thresholds::evidence.accepted)
    return from(f);
  return std::nullopt;
}

}  // namespace swingbank::validate::diagnose
