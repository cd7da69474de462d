// Pairs of effects: addition of a second effect, replacement of the first effect, and exchange of effects
// between pairs.
#include <algorithm>
#include <array>
#include <optional>

#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// Copies the values of the `free` parameters of `like` from one plant to another, if both have them.
void copy_values(const sim::plant::Plant& from, const sim::plant::Plant& like,
                 const std::vector<fit::FreeParameter>& free, sim::plant::Plant& to) {
  for (const fit::FreeParameter& f : free) {
    const auto source = sim::plant::same_parameter(from, like, f.id),
               target = sim::plant::same_parameter(to, like, f.id);
    if (source && target)
      sim::plant::parameter_value(to, *target) = sim::plant::parameter_value(from, *source);
  }
}

/// Returns the second effect of a pair at its values in the fit `in`.
Judgement staying(const Hypothesis& h, const fit::Fit& in) {
  Judgement stays;
  stays.hypothesis = h;
  stays.fit.plant = h.plant;
  copy_values(in.plant, h.plant, h.free, stays.fit.plant);
  return stays;
}
/// Returns `h` on the base model `then`, not fitted. The start values of the effects added before are those
/// of `then`; all other start values are those of `from`.
Judgement begun(const BaseModel& then, Hypothesis h, const fit::Fit& from) {
  Judgement j;
  j.fit.failed = "not fitted";
  j.fit.plant = h.plant;
  copy_values(from.plant, h.plant, free_of(h, then.prior_sd), j.fit.plant);
  copy_values(then.fit.plant, then.plant, then.own, j.fit.plant);
  for (const auto& e : from.events) j.fit.events.emplace_back().state = e.state;
  bring(then, h);
  j.hypothesis = std::move(h);
  return j;
}

}  // namespace

BaseModel after(const BaseModel& base_model, const Judgement& j) {
  return {.events = base_model.events,
          .plant = j.hypothesis.plant,
          .conventions = j.hypothesis.conventions,
          .library = base_model.library,
          .fit = j.fit,
          .own = j.hypothesis.free,
          .with = full_name(j.hypothesis),
          .prior_sd = base_model.prior_sd,
          .threads = base_model.threads,
          .stop = base_model.stop,
          .reached = base_model.reached};
}

void bring(const BaseModel& base_model, Hypothesis& h) {
  h.with = base_model.with;
  for (const fit::FreeParameter& f : base_model.own) {
    h.free.push_back({sim::plant::same_parameter(h.plant, base_model.plant, f.id).value(), f.prior_sd});
    const double value = sim::plant::parameter_value(base_model.fit.plant, f.id);
    for (auto* starts : {&h.starts, &h.further})
      for (auto& start : *starts) start.push_back(value);
  }
}

std::vector<Judgement> exchanges(const BaseModel& base_model, const Judgement& pair,
                                 const std::vector<Judgement>& alone) {
  const auto all = base_model.hypotheses();
  const auto first = std::ranges::find(all, pair.hypothesis.with, &Hypothesis::name),
             second = std::ranges::find(all, pair.hypothesis.name, &Hypothesis::name);
  if (first == all.end() || second == all.end()) return {};  // one effect cannot be added without the other
  const Judgement stays = staying(*second, pair.fit);
  const BaseModel then = after(base_model, stays);
  std::vector<Judgement> competitors;
  for (Hypothesis& h : then.hypotheses()) {
    const auto known = std::ranges::find(alone, h.name, [](const Judgement& j) { return j.hypothesis.name; });
    const bool in_slot = first->slot >= 0 && h.slot == first->slot;
    const bool accepted_alone = known != alone.end() && known->accepted && known->hypothesis.with.empty();
    if (h.name == first->name || h.name == second->name || !(in_slot || accepted_alone)) continue;
    const bool found = known != alone.end() && known->fitted;
    competitors.push_back(begun(then, std::move(h), found ? known->fit : pair.fit));
  }
  return competitors;
}

void try_begun(const BaseModel& base_model, Judgement& j) {
  if (j.fit.events.empty()) return;  // the candidate has no start
  const auto free = free_of(j.hypothesis, base_model.prior_sd);
  if (fit::Fit f = fit::fit(j.hypothesis.under_test(), base_model.events, free,
                            fit::continued({.lenient = true}, j.fit, free));
      f.failed.empty())
    j.fit = std::move(f);
}

Judgement crossed(const BaseModel& base_model, const Cross& cross) {
  Judgement none;
  none.hypothesis.with = cross.stays;
  none.hypothesis.name = cross.joins;
  none.fit.failed = "one of its effects can be added only together with another effect";
  const auto named = [](std::vector<Hypothesis> all, const std::string& name) {
    std::erase_if(all, [&](const Hypothesis& h) { return h.name != name; });
    return all;
  };
  const auto first = named(base_model.hypotheses(), cross.stays);
  if (first.empty()) return none;
  const Judgement stays = staying(first.front(), cross.stays_in->fit);
  const BaseModel then = after(base_model, stays);
  auto second = named(then.hypotheses(), cross.joins);
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
  for (const Judgement& one : pairs)
    for (const Judgement& other : pairs)
      for (const std::size_t i : {0, 1})
        for (const std::size_t k : {0, 1}) {
          const std::string &joins = *both(one)[i], &stays = *both(other)[k];
          const Judgement* between = known(*both(one)[1 - i], *both(other)[1 - k]);
          const bool three = between && between != &one && between != &other && found(*between) &&
                             found(one) && found(other);
          if (!three || one.gain < other.gain || joins == stays || known(joins, stays)) continue;
          const double expected = one.gain + other.gain - between->gain;
          if (!best || expected > best->expected) best = {joins, &one, stays, &other, expected};
        }
  return best;
}

}  // namespace swingbank::validate::hypothesis
