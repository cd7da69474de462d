// Alternation of diagnosis and addition until the residual is noise or no effect helps.
#include <fmt/format.h>

#include <algorithm>

#include "validate/add/add.hpp"
#include "validate/diagnose/diagnose.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::add {
namespace {

/// Returns the effects that the diagnosis names. If it names none, more than one effect may be missing: then
/// returns the hypothesis with the most evidence among those that improve every held-out event of the
/// diagnosis.
std::vector<std::string> next_effects(const diagnose::Diagnosis& d) {
  if (!d.effects.empty()) return d.effects;
  const auto helps = [](const hypothesis::Judgement& j) {
    return !j.held_out.empty() &&
           std::ranges::all_of(j.held_out, [](const hypothesis::HeldOut& h) { return h.after < h.before; });
  };
  const auto best = std::ranges::find_if(d.ranked, helps);
  if (best == d.ranked.end()) return {};
  return {best->hypothesis.name};
}

/// Removes every earlier added control whose evidence is now too low (thresholds::addition.stays).
void prune(Completion& c, const std::vector<record::Record>& records, const AddOptions& options) {
  std::vector<std::string> earlier;
  for (std::size_t a = 0; a + 1 < c.added.size(); ++a)
    for (const AddedEffect& e : c.added[a].effects) earlier.push_back(e.name);
  for (const std::string& name : earlier) {
    const sim::Effect* effect = c.model.library.find(name);
    const auto& controls = c.model.plant.controls;
    const auto at = std::ranges::find(controls, effect, &sim::plant::Block::effect);
    if (effect == nullptr || at == controls.end()) continue;
    Removal r = try_without(c.model, static_cast<std::size_t>(at - controls.begin()), records, options);
    if (r.evidence > thresholds::addition.stays) continue;
    c.model = r.model;
    c.removed.push_back(std::move(r));
  }
}

void work(const std::vector<record::Record>& records, const AddOptions& options, Completion& c) {
  constexpr std::size_t kMostAdditions = 4;
  diagnose::DiagnoseOptions how;
  how.prior_sd = options.calibrate.prior_sd;
  how.adequate = options.calibrate.adequate;
  how.events = options.calibrate.events;
  how.progress = options.calibrate.progress;
  std::string names;
  while (c.added.size() < kMostAdditions) {
    const diagnose::Diagnosis d =
        diagnose::diagnose(c.model, calibrate::seen_records(records, options.calibrate.held_out), how);
    if (d.verdict == diagnose::Verdict::interrupted) throw Interrupted{};
    if (d.verdict == diagnose::Verdict::adequate) {
      c.adequate = true;
      c.sentence = c.added.empty() ? d.sentence : "Adequate with " + names + ": " + d.sentence;
      return;
    }
    const std::vector<std::string> next = next_effects(d);
    if (next.empty()) {
      c.sentence = (names.empty() ? "" : "With " + names + ": ") + d.sentence;
      return;
    }
    Addition a = add_effects(c.model, next, records, options);
    if (!a.earns) {
      c.sentence = a.sentence;
      return;
    }
    names += (names.empty() ? "" : ", ") + a.hypothesis.name;
    c.model = a.model;
    const bool done = a.adequate;
    const std::string residual = calibrate::residual_text(a.scores());
    c.added.push_back(std::move(a));
    prune(c, records, options);
    if (done) {
      c.adequate = true;
      c.sentence = "Adequate with " + names + ": " + residual + " in every event.";
      return;
    }
  }
  c.sentence =
      fmt::format("Not adequate: the residual exceeds noise after {} additions ({}).", kMostAdditions, names);
}

}  // namespace

Completion add_until_adequate(const plant::PlantModel& model, const std::vector<record::Record>& records,
                              const AddOptions& options) {
  Completion c;
  c.model = model;
  try {
    work(records, options, c);
  } catch (const Interrupted&) {
    if (c.added.empty()) throw;
    throw fit::InterruptedFit{{}, c.added.back().with};
  }
  return c;
}

}  // namespace swingbank::validate::add
