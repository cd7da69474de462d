#include "validate/hypothesis/grow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/problem.hpp"
#include "sim/plant/usual.hpp"
#include "validate/fit/rao_score.hpp"
#include "validate/hypothesis/judge.hpp"
#include "validate/playin/can_run.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// Shares of the room up to a bound, or down to the other, at which a part is tried.
constexpr std::array<double, 6> kShares = {0.01, 0.05, 0.2, -0.01, -0.05, -0.2};
constexpr double kWidestRoom = 20;      ///< counted of a room that a bound leaves [the parameter's unit]
constexpr double kPartSpread = 2.0;     ///< of ln(value): as of groups of neutral parameters
constexpr double kLeastOfTrial = 0.05;  ///< of the value tried: the least that the score test may start from
constexpr double kCompanionMoves = 1.5;
constexpr std::array<double, 5> kMultiplesBeside = {1.0, 0.1, 0.3, 3.0, 10.0};
constexpr int kGrowSteps = 12, kMostParts = 3;

struct Part {
  sim::plant::ParameterId id;
  double promise = 0;      ///< by how much chi2 would fall
  sim::plant::Plant from;  ///< to start from
};

/// The plant that the beliefs of a fit are about.
sim::plant::Plant believed(const fit::Fit& f) {
  sim::plant::Plant plant = f.plant;
  for (const fit::FittedParameter& p : f.parameters) sim::plant::parameter_value(plant, p.where.id) = p.start;
  return plant;
}

/// Own parameters of the hypothesis's effect that it leaves off.
std::vector<sim::plant::ParameterId> left_off(const Hypothesis& h) {
  const int block = h.free.front().id.block;
  const auto& effect = sim::plant::block_effect(h.plant, block);
  const auto& values = sim::plant::block_at(h.plant, block).p;
  std::vector<sim::plant::ParameterId> off;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const sim::plant::ParameterId id{block, static_cast<int>(i)};
    const auto& p = effect.parameters[i];
    const bool is_off = values[i] == 0.0 || values[i] == p.neutral;
    if (!p.is_code() && is_off &&
        std::ranges::none_of(h.free, [&](const fit::FreeParameter& f) { return f.id == id; }))
      off.push_back(id);
  }
  return off;
}

/// Own free parameters that act only where the part does, as the rate feedback's time constant.
std::vector<sim::plant::ParameterId> companions(const fit::ScoreTest& score, const Hypothesis& h,
                                                const sim::plant::Plant& without,
                                                const sim::plant::Plant& with) {
  const auto acts = [&](sim::plant::Plant plant, sim::plant::ParameterId id) {
    const sim::plant::Plant before = plant;
    const auto& p = sim::plant::parameter_record(plant, id);
    double& value = sim::plant::parameter_value(plant, id);
    const auto [low, high] = sim::plant::search_range(p, value);
    value = std::clamp(kCompanionMoves * value, low, high);
    return score.apart({before, h.conventions}, {plant, h.conventions});
  };
  std::vector<sim::plant::ParameterId> found;
  for (const fit::FreeParameter& f : h.free)
    if (f.id.block == h.free.front().id.block && acts(with, f.id) && !acts(without, f.id))
      found.push_back(f.id);
  return found;
}

/// Tries one part at several sizes, with what acts only beside it at multiples of its values.
void try_part(const fit::ScoreTest& score, const Hypothesis& h, const fit::Fit& f, sim::plant::ParameterId id,
              std::optional<Part>& best) {
  const auto& p = sim::plant::parameter_record(h.plant, id);
  const double now = sim::plant::parameter_value(h.plant, id);
  const auto range = sim::plant::search_range(p, now);
  const auto moved_by = [&](double share) {
    sim::plant::Plant moved = f.plant;
    sim::plant::parameter_value(moved, id) +=
        share * std::min(kWidestRoom, share > 0 ? range.high - now : now - range.low);
    return moved;
  };
  const auto beside = companions(score, h, f.plant, moved_by(kShares[1]));
  std::vector<sim::plant::Plant> trials;
  for (const double share : kShares)
    for (const double multiple : kMultiplesBeside) {
      sim::plant::Plant moved = moved_by(share);
      const double tried = sim::plant::parameter_value(moved, id);
      if (tried == now || tried == 0.0) break;
      for (const auto& other : beside) {
        const auto& record = sim::plant::parameter_record(moved, other);
        double& value = sim::plant::parameter_value(moved, other);
        const auto [low, high] = sim::plant::search_range(record, value);
        value = std::clamp(multiple * value, low, high);
      }
      trials.push_back(std::move(moved));
      if (beside.empty()) break;
    }
  const auto changes = score.changes_to(trials, h.conventions);
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const auto& change = changes[k];
    if (!change || !(change->gain() > (best ? best->promise : thresholds::addition.strong.value))) continue;
    double& value = sim::plant::parameter_value(trials[k], id);
    value = now + std::clamp(change->share(), kLeastOfTrial, 1.0) * (value - now);
    best = Part{id, change->gain(), std::move(trials[k])};
  }
}

/// The best of the parts. Where the fit ended only lenient steps may get through; their slopes will do then.
std::optional<Part> most_promising(const event::WhitenedEvents& events, const Hypothesis& h,
                                   const fit::Fit& f) {
  const auto off = left_off(h);
  if (off.empty()) return std::nullopt;
  for (const bool lenient : {false, true}) {
    try {
      const fit::ScoreTest score(events, {believed(f), h.conventions}, f, lenient);
      std::optional<Part> best;
      for (const auto& id : off) try_part(score, h, f, id, best);
      return best;
    } catch (const InputError&) {  // its slopes cannot be run
    }
  }
  return std::nullopt;
}

/// The hypothesis with the part free, at its value to start from.
Hypothesis with_part(Hypothesis h, const Part& part) {
  const double value = sim::plant::parameter_value(part.from, part.id);
  sim::plant::parameter_value(h.plant, part.id) = value;
  const auto own =
      std::ranges::find_if(h.free, [&](const fit::FreeParameter& f) { return f.id.block != part.id.block; });
  const auto at = own - h.free.begin();
  h.free.insert(own, {part.id, kPartSpread});
  for (auto& start : h.starts) start.insert(start.begin() + at, value);
  return h;
}

}  // namespace

void grow(const event::WhitenedEvents& events, double spread, Hypothesis& h, fit::Fit& fit) {
  if (!h.drawn || h.free.empty() || !fit.failed.empty()) return;
  for (int parts = 0; parts < kMostParts; ++parts) {
    const auto part = most_promising(events, h, fit);
    if (!part) return;
    Hypothesis grown = with_part(h, *part);
    const auto free = free_of(grown, spread);
    fit::FitOptions o = fit::continued({.iterations = kGrowSteps, .lenient = true}, fit, free);
    o.values = fit::values_of(part->from, free);
    fit::Fit with = fit::fit(grown.under_test(), events, free, o);
    if (!with.failed.empty() || !(fit::gain(fit, with, fit::criterion) > thresholds::addition.strong)) return;
    h = std::move(grown);
    fit = std::move(with);
  }
}

}  // namespace swingbank::validate::hypothesis
