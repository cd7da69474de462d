#include "validate/hypothesis/detail/starts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/problem.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// The score test looks at kScored starts, and the misfit is taken of kScreened starts.
constexpr std::size_t kScored = 6, kScreened = 10;
/// The score test looks at more draws where the standard values do not act, because each of them picks up
/// elsewhere.
constexpr std::size_t kProvoked = 30;
/// Shares of the standard amplitude: kSmall is where the answer is straight, kLeastShare is the least that a
/// start has.
constexpr double kSmall = 0.01, kLeastShare = 1e-3;
/// Draws that act are looked for among so many.
constexpr std::size_t kProvoking = 80;
/// So many more draws of an effect that acts in full or not at all: its gains may lie decades from standard.
constexpr std::size_t kFurtherDraws = 80;
/// On the way from a draw that cannot be run to one that does nothing, kHalvings halvings find the first
/// point that runs. A start lies beyond this point by one of these shares of the rest of the way.
constexpr std::array<double, 4> kBeyond = {0.02, 0.05, 0.1, 0.2};
constexpr int kHalvings = 6;

/// What the hypothesis's own block makes may be heard by an exciter alone, and there may be none. Its states
/// would still make other steps, which look like an answer.
bool unheard(const Hypothesis& h) {
  if (!h.drawn || h.free.empty()) return false;
  const sim::Slot slot = sim::plant::block_effect(h.plant, h.free.front().id.block).slot;
  const bool for_exciter =
      slot == sim::Slot::compensator || slot == sim::Slot::stabiliser || slot == sim::Slot::limiter;
  return for_exciter && std::ranges::none_of(h.plant.controls, [](const sim::plant::Block& b) {
           return b.effect->slot == sim::Slot::exciter;
         });
}

}  // namespace

StartFinder::StartFinder(const Stage& stage) : stage_(stage) {
  if (!(stage.fit.misfit() < thresholds::search.nearly_fits)) return;
  try {
    score_.emplace(stage.events, stage.under_test(), stage.fit, true);
  } catch (const InputError&) {  // where the fit ended its slopes cannot be run: starts are screened instead
  }
}

Candidate StartFinder::of(Hypothesis h) const {
  Candidate c;
  if (unheard(h)) return c;
  bring(stage_, h);
  const bool provoked = provoke(h);
  if (score_)
    score(h, provoked ? kProvoked : kScored, c);
  else
    screen(h, c);
  c.hypothesis = std::move(h);
  return c;
}

sim::plant::Plant prior_mean(const Stage& stage, const Hypothesis& h) {
  sim::plant::Plant plant = started(h, h.starts.front());
  for (const fit::FreeParameter& f : stage.own) {
    const auto id = sim::plant::same_parameter(plant, stage.plant, f.id).value();
    sim::plant::parameter_value(plant, id) = sim::plant::parameter_value(stage.plant, f.id);
  }
  return plant;
}
std::vector<double> StartFinder::unbent(const Hypothesis& h) const {
  std::vector<int> bent;
  for (const auto& p : stage_.fit.parameters) {
    const bool own =
        std::ranges::any_of(stage_.own, [&](const fit::FreeParameter& f) { return f.id == p.where.id; });
    if (!own && p.start > 0 &&
        std::abs(std::log(p.value / p.start)) > thresholds::search.bent * p.where.spread)
      bent.push_back(p.where.id.block);
  }
  if (bent.empty()) return {};
  const auto free = free_of(h, stage_.spread);
  sim::plant::Plant plant = with_values(h, free, beside_fit(h, h.starts.front()));
  for (const auto& p : stage_.fit.parameters)
    if (const auto id = sim::plant::same_parameter(plant, stage_.plant, p.where.id);
        id && std::ranges::count(bent, p.where.id.block) > 0)
      sim::plant::parameter_value(plant, *id) = p.start;
  return fit::values_of(plant, free);
}
bool StartFinder::provoke(Hypothesis& h) const {
  if (!h.drawn || largest_move(h, h.starts.front()) > thresholds::search.acting) return false;
  const std::size_t own = h.free.size() - stage_.own.size();
  std::vector<std::vector<double>> acting, idle, failing;
  for (auto& draw :
       further_draws(h, own, kProvoking,
                     stage_.events.front().record.t.back() - stage_.events.front().record.t.front())) {
    draw.insert(draw.end(), h.starts.front().begin() + static_cast<std::ptrdiff_t>(own),
                h.starts.front().end());
    const double move = largest_move(h, draw);
    (move > thresholds::search.acting ? acting
     : std::isnan(move)               ? failing
                                      : idle)
        .push_back(std::move(draw));
    if (acting.size() == kProvoked) break;
  }
  if (!idle.empty() && !failing.empty())
    for (std::size_t k = 0; k < kProvoking && acting.size() < kProvoked; ++k)
      if (auto start =
              between(h, failing[k % failing.size()], idle[k % idle.size()], kBeyond[k % kBeyond.size()]))
        acting.push_back(std::move(*start));
  if (acting.empty()) return false;
  h.starts = std::move(acting);
  return true;
}
std::optional<std::vector<double>> StartFinder::between(const Hypothesis& h,
                                                        const std::vector<double>& failing,
                                                        const std::vector<double>& idle,
                                                        double beyond) const {
  const auto at = [&](double share) {
    auto values = failing;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += share * (idle[i] - values[i]);
    return values;
  };
  double fails = 0, runs = 1;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (fails + runs);
    (std::isnan(moves(h, beside(h, at(middle)), 0)) ? fails : runs) = middle;
  }
  auto start = at(runs + beyond * (1 - runs));
  if (largest_move(h, start) > thresholds::search.acting) return start;
  return std::nullopt;
}
void StartFinder::screen(const Hypothesis& h, Candidate& c) const {
  std::vector<sim::plant::Plant> plants;
  for (const auto& values : std::span(h.starts).first(std::min(kScreened, h.starts.size())))
    plants.push_back(started(h, values));
  const auto misfit =
      left_by_each(plants, h.conventions, stage_.events, std::vector<fit::EventState>(stage_.events.size()));
  std::vector<std::size_t> order;
  bool acts = false;
  for (std::size_t k = 0; k < plants.size(); ++k) {
    if (!std::isfinite(misfit[k])) continue;
    order.push_back(k);
    acts = acts || this->acts(h, plants[k]);
  }
  if (!acts) return;
  std::ranges::sort(order.begin() + 1, order.end(), {}, [&](std::size_t k) { return misfit[k]; });
  nest(h, c);
  for (const std::size_t k : order) c.starts.push_back(std::move(plants[k]));
}
std::vector<double> StartFinder::beside_fit(const Hypothesis& h, const std::vector<double>& start) const {
  sim::plant::Plant plant = started(h, start);
  for (const auto& p : stage_.fit.parameters)
    if (const auto id = sim::plant::same_parameter(plant, stage_.plant, p.where.id))
      sim::plant::parameter_value(plant, *id) = p.value;
  return fit::values_of(plant, free_of(h, stage_.spread));
}
sim::plant::Plant StartFinder::with_values(const Hypothesis& h, const std::vector<fit::FreeParameter>& free,
                                           const std::vector<double>& values) {
  sim::plant::Plant plant = h.plant;
  for (std::size_t i = 0; i < free.size(); ++i) sim::plant::parameter_value(plant, free[i].id) = values[i];
  return plant;
}
void StartFinder::nest(const Hypothesis& h, Candidate& c) const {
  const auto free = free_of(h, stage_.spread);
  std::vector<std::vector<double>> starts;
  std::vector<sim::plant::Plant> plants;
  for (const auto& start : std::span(h.starts).first(std::min(kScreened, h.starts.size()))) {
    starts.push_back(beside_fit(h, start));
    plants.push_back(with_values(h, free, starts.back()));
  }
  const auto misfit =
      left_by_each(plants, h.conventions, stage_.events, std::vector<fit::EventState>(stage_.events.size()));
  for (std::size_t k = 0; k < starts.size(); ++k)
    if (std::isfinite(misfit[k])) c.nested.emplace_back(misfit[k], std::move(starts[k]));
  if (!c.nested.empty()) std::ranges::sort(c.nested.begin() + 1, c.nested.end());
}
std::vector<std::size_t> StartFinder::amplitudes(const Hypothesis& h,
                                                 const std::vector<double>& standard) const {
  const auto free = free_of(h, stage_.spread);
  std::vector<std::size_t> found;
  std::size_t event = 0;  // the first event in which the effect acts
  double whole = 0;
  for (std::size_t e = 0; e < stage_.events.size() && !(whole > thresholds::search.acting); ++e)
    if (const double square = moves(h, with_values(h, free, standard), e); square > whole)
      event = e, whole = square;
  for (std::size_t i = free.size() - h.free.size(); i < free.size(); ++i) {
    const double neutral = sim::plant::parameter_record(h.plant, free[i].id).neutral;
    if (!(neutral < standard[i]) && !(neutral > standard[i])) continue;
    auto off = standard;
    off[i] = neutral;
    if (moves(h, with_values(h, free, off), event) <
        std::max(thresholds::search.off * whole,
                 std::min(thresholds::search.acting.value, thresholds::search.off_beside * whole)))
      found.push_back(i);
  }
  return found;
}
sim::plant::Plant StartFinder::beside(const Hypothesis& h, const std::vector<double>& start) const {
  return with_values(h, free_of(h, stage_.spread), beside_fit(h, start));
}
double StartFinder::largest_move(const Hypothesis& h, const std::vector<double>& start) const {
  const sim::plant::Plant plant = beside(h, start);
  double most = 0;
  for (std::size_t e = 0;
       e < stage_.events.size() && !(most > thresholds::search.acting) && !std::isnan(most); ++e) {
    const double move = moves(h, plant, e);
    if (!(move <= most)) most = move;
  }
  return most;
}
double StartFinder::moves(const Hypothesis& h, const sim::plant::Plant& plant, std::size_t event) const {
  const event::FitEvent& e = stage_.events[event];
  const Eigen::VectorXd& noise = stage_.events.noise(event).deviation;
  const fit::EventFit& at = stage_.fit.events[event];
  try {
    const playin::Response r = event::play({plant, h.conventions}, e, at.state);
    double square = 0;
    for (std::size_t c = 0; c < e.channels.size(); ++c)
      for (std::size_t k = 0; k < r.of(e.channels[c]).size(); ++k)
        square +=
            std::pow((r.of(e.channels[c])[k] - at.model[c][k]) / noise[static_cast<Eigen::Index>(c)], 2);
    return square;
  } catch (const InputError&) {
    return std::nan("");
  }
}
void StartFinder::score(const Hypothesis& h, std::size_t looks, Candidate& c) const {
  const auto free = free_of(h, stage_.spread);
  const auto standard = beside_fit(h, h.starts.front());
  const auto which = amplitudes(h, standard);
  const auto at = [&](std::vector<double> values, double share) {
    for (const std::size_t i : which) {
      const double neutral = sim::plant::parameter_record(h.plant, free[i].id).neutral;
      values[i] = neutral + share * (values[i] - neutral);
    }
    return values;
  };
  std::vector<fit::ScoreTest::Change> changes;
  std::vector<std::pair<double, std::vector<double>>> starts;
  const std::size_t looked = which.empty() ? h.starts.size() : std::min(looks, h.starts.size());
  std::vector<std::vector<double>> values_of_start;
  std::vector<sim::plant::Plant> plants;
  for (const auto& start : std::span(h.starts).first(looked)) {
    values_of_start.push_back(beside_fit(h, start));
    plants.push_back(with_values(h, free, values_of_start.back()));
  }
  auto wholes = score_->changes_to(plants, h.conventions);
  for (std::size_t k = 0; k < looked; ++k) {
    const bool scored = k < looks;
    const auto& values = values_of_start[k];
    auto& whole = wholes[k];
    if (!whole) continue;
    if (which.empty()) starts.emplace_back(whole->rise(), values);
    if (!scored) continue;
    double gain = whole->gain(), share = std::clamp(whole->share(), kLeastShare, 1.0);
    changes.push_back(std::move(*whole));
    std::vector<playin::Direction> along;
    for (std::size_t i = free.size() - h.free.size(); i < free.size(); ++i) {
      const double neutral = sim::plant::parameter_record(h.plant, free[i].id).neutral;
      const bool asked = which.empty() ? !std::isnan(neutral) : std::ranges::count(which, i) > 0;
      if (asked)
        along.push_back({.kind = playin::Direction::Kind::parameter,
                         .parameter = free[i].id,
                         .scale = values[i] - neutral});
    }
    if (!along.empty())
      for (auto& slope : score_->slopes({with_values(h, free, at(values, kSmall)), h.conventions}, along)) {
        if (!which.empty() && slope.gain() > gain)
          gain = slope.gain(), share = std::clamp(slope.share(), kLeastShare, 1.0);
        changes.push_back(std::move(slope));
      }
    if (!which.empty()) starts.emplace_back(-gain, at(values, share));
  }
  if (which.empty() && h.drawn) add_far(h, starts);
  c.promise = score_->joint_gain(changes);
  if (starts.empty() || std::ranges::none_of(changes, [](const auto& x) { return x.square > 0; })) return;
  c.starts = {prior_mean(stage_, h)};
  // the gain of a few large changes says little about that of a small one
  if (c.promise < thresholds::search.hopeless &&
      (!which.empty() || starts.size() >= std::min(h.starts.size(), looks)))
    return;
  c.unbent = unbent(h);
  const double reach = thresholds::search.out_of_reach * stage_.fit.chi2;
  if (!which.empty() || starts.front().first < reach) c.nested.emplace_back(0.0, standard);
  std::ranges::sort(starts);
  for (auto& start : starts)
    if (c.nested.empty() || (c.nested.size() < kTries && start.first < reach))
      c.nested.push_back(std::move(start));
}
void StartFinder::add_far(const Hypothesis& h,
                          std::vector<std::pair<double, std::vector<double>>>& starts) const {
  const auto free = free_of(h, stage_.spread);
  const std::size_t own = h.free.size() - stage_.own.size();
  std::vector<std::vector<double>> values;
  std::vector<sim::plant::Plant> plants;
  for (auto& draw : further_draws(h, own, kFurtherDraws, 0)) {
    draw.insert(draw.end(), h.starts.front().begin() + static_cast<std::ptrdiff_t>(own),
                h.starts.front().end());
    values.push_back(beside_fit(h, draw));
    plants.push_back(with_values(h, free, values.back()));
  }
  const auto changes = score_->changes_to(plants, h.conventions);
  for (std::size_t k = 0; k < plants.size(); ++k)
    if (changes[k]) starts.emplace_back(changes[k]->rise(), std::move(values[k]));
}
bool StartFinder::acts(const Hypothesis& h, const sim::plant::Plant& plant) const {
  try {
    for (std::size_t i = 0; i < stage_.events.size(); ++i) {
      const event::WhitenedEvent e = stage_.events.whitened(i);
      if (differ(event::play({plant, h.conventions}, e.event, {}),
                 event::play(stage_.under_test(), e.event, {}), e))
        return true;
    }
  } catch (const InputError&) {  // smaller steps than those of a search do not pass it
  }
  return false;
}
bool StartFinder::differ(const playin::Response& x, const playin::Response& y,
                         const event::WhitenedEvent& of) {
  const event::FitEvent& e = of.event;
  for (std::size_t c = 0; c < e.channels.size(); ++c)
    for (std::size_t k = 0; k < x.of(e.channels[c]).size(); ++k)
      if (std::abs(x.of(e.channels[c])[k] - y.of(e.channels[c])[k]) >
          1e-2 * of.noise.deviation[static_cast<Eigen::Index>(c)])
        return true;
  return false;
}
}  // namespace swingbank::validate::hypothesis
