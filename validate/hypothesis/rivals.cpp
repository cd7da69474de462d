// Rivals of the best hypothesis get a chance.
#include "validate/hypothesis/rivals.hpp"

#include <algorithm>

#include "base/in_parallel.hpp"
#include "base/stop_signal.hpp"
#include "validate/hypothesis/grow.hpp"
#include "validate/hypothesis/posterior.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// Does something with each judgement, on all cores, and counts its evidence anew.
template <class F>
void each(const Stage& stage, const std::vector<Judgement*>& some, event::Phase phase,
          const event::Progress& report, F act) {
  in_parallel(
      some.size(),
      [&](std::size_t k) {
        if (stage.stopped()) return;
        until_interrupted([&] { act(*some[k]); });
        some[k]->gain = fit::gain(stage.fit, some[k]->fit, fit::criterion);
      },
      [&](int done, std::size_t k) {
        if (report) report(phase, full_name(some[k]->hypothesis), done, static_cast<int>(some.size()));
      },
      stage.threads);
}
template <class Which>
std::vector<Judgement*> those(std::vector<Judgement>& tried, Which which) {
  std::vector<Judgement*> some;
  for (Judgement& j : tried)
    if (j.fitted && j.fit.failed.empty() && which(j)) some.push_back(&j);
  return some;
}
void best_first(std::vector<Judgement>& tried) {
  std::ranges::stable_sort(tried, std::greater<>(), &Judgement::gain);
}
/// Looks at them elsewhere; each starts from what all of them have found under the same names, too.
void look(const Stage& stage, const std::vector<Judgement*>& some, const event::Progress& report) {
  std::vector<sim::plant::Plant> found;  // as they stand before any of them is looked at
  for (const Judgement* j : some) found.push_back(j->fit.plant);
  each(stage, some, event::Phase::other_optima, report, [&](Judgement& j) {
    try_basins(stage, j, found);
    j.looked_at = true;
  });
}
bool nearly_fits(const Judgement& j) { return j.fit.misfit() < thresholds::search.nearly_fits; }
/// Shared slots hold several effects, which are no rivals of each other.
bool rivals(const Judgement& a, const Judgement& b) {
  return &a == &b || (a.hypothesis.slot >= 0 && a.hypothesis.slot == b.hypothesis.slot);
}

}  // namespace

void give_rivals_a_chance(const Stage& stage, std::vector<Judgement>& tried, const event::Progress& report) {
  if (tried.empty() || tried.front().hypothesis.slot < 0) return;
  // One that is worse than nothing has not arrived anywhere, which says nothing of it.
  const double near = thresholds::evidence.near * tried.front().gain;
  const auto some = those(
      tried, [&](const Judgement& j) { return rivals(tried.front(), j) && (j.gain > near || j.gain < 0); });
  if (some.empty()) return;
  const fit::Fit leader =
      (*std::ranges::max_element(some, {}, [](const Judgement* j) { return j->gain; }))->fit;
  each(stage, some, event::Phase::further_starts, report, [&](Judgement& j) {
    if (!j.looked_at) try_further(stage, leader, j);
    fit_on(stage, j);
    grow(stage.events, stage.spread, j.hypothesis, j.fit);
  });
  best_first(tried);
  // What could still become probable beside the best one of its slot, and whatever nearly fits, may lie at
  // the lesser of several optima. How far behind it stands does not tell: which optimum a fit ends at,
  // roundings decide. Where much is left, though, what else could follow linearly says little of a draw.
  const double reach = tried.front().gain - out_of_reach();
  look(stage,
       those(tried,
             [&](const Judgement& j) {
               return !j.looked_at && rivals(tried.front(), j) && (j.gain > reach || nearly_fits(j));
             }),
       report);
  best_first(tried);
}

std::vector<std::size_t> look_at_next(const Stage& stage, std::vector<Judgement>& tried,
                                      const event::Progress& report) {
  if (tried.empty()) return {};
  const double best = std::ranges::max_element(tried, {}, &Judgement::gain)->gain;
  const auto left = those(tried, [&](const Judgement& j) {
    return !j.looked_at && j.hypothesis.drawn && nearly_fits(j) &&
           j.gain > std::max(thresholds::evidence.accepted.value, thresholds::evidence.near * best);
  });
  if (left.empty()) return {};
  const Judgement& next = **std::ranges::max_element(left, {}, [](const Judgement* j) { return j->gain; });
  std::vector<Judgement*> some;
  for (Judgement* j : left)
    if (rivals(next, *j)) some.push_back(j);
  each(stage, some, event::Phase::further_starts, report, [&](Judgement& j) { fit_on(stage, j); });
  look(stage, some, report);
  std::vector<std::size_t> which;
  for (const Judgement* j : some) which.push_back(static_cast<std::size_t>(j - tried.data()));
  return which;
}

}  // namespace swingbank::validate::hypothesis
