#include "validate/add/at_once.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "validate/hypothesis/search.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::add {
namespace {

bool is_noise(const fit::Fit& f, const noise::WhitenedEvents& events, double least) {
  const int pre_event = calibrate::pre_event_samples(events);
  for (std::size_t e = 0; e < events.size(); ++e) {
    const double limit = calibrate::reduced_chi2_limit(events[e], f.events[e], pre_event, least);
    if (!thresholds::within_limit(f.events[e].reduced_chi2(), limit)) return false;
  }
  return true;
}

/// Fits the effect's own parameters, which brings the response close in few short steps, then all parameters.
fit::Fit fitted(const hypothesis::Hypothesis& h, const noise::WhitenedEvents& events,
                const AddOptions& options) {
  fit::FitOptions o{.lenient = true};
  o.errors = false;
  const fit::Fit own = fit::fit(h.under_test(), events, h.free, o);
  if (!own.failed.empty()) return own;
  if (options.reached) options.reached(own);
  const auto free = hypothesis::free_of(h, options.calibrate.prior_sd);
  o = fit::continued({.lenient = true}, own, free);
  o.goal = {thresholds::noise.measurable * own.values, o.iterations};
  return fit::fit(h.under_test(), events, free, o);
}

}  // namespace

std::optional<Addition> add_at_once(const plant::PlantModel& model, const hypothesis::Hypothesis& hypothesis,
                                    const std::vector<record::Record>& records, const AddOptions& options) {
  const noise::WhitenedEvents events = noise::whitened_events(
      model, calibrate::seen_records(records, options.calibrate.held_out), options.calibrate.events);
  Addition a;
  a.hypothesis = hypothesis;
  a.effects = {{hypothesis.name, hypothesis.what, 0}};
  a.with = fitted(hypothesis, events, options);
  if (!a.with.failed.empty() || !is_noise(a.with, events, options.calibrate.adequate)) return std::nullopt;
  if (options.reached) options.reached(a.with);
  a.model = model;
  a.model.plant = a.with.plant;
  a.model.conventions = hypothesis.conventions;
  a.own = static_cast<int>(hypothesis.free.size());
  a.parameters = a.with.parameters;
  // A fit lists the effect's parameters last.
  std::rotate(a.parameters.begin(), a.parameters.end() - a.own, a.parameters.end());
  a.adequate = true;
  a.sentence = fmt::format(
      "{} added: one fit from its default values gives the reduced chi-square {:.3g}; the residual is noise.",
      hypothesis.name, a.with.reduced_chi2());
  return a;
}

}  // namespace swingbank::validate::add
