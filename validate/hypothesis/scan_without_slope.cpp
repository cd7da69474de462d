// A scan over parameters that act through instants alone, as the time of a limiter's timer does: slopes do
// not lead to where an instant falls into another swing.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "sim/plant/usual.hpp"
#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {
namespace {

constexpr std::array<double, 10> kMultiples = {0.3, 0.5, 0.7, 0.85, 0.95, 1.05, 1.18, 1.4, 2.0, 3.3};
/// Multiples at which it shows whether a parameter acts at all.
constexpr double kScanLess = 0.7, kScanMore = 1.4;
/// The kScanFitted multiples that leave least get kScanOwnSteps steps of the hypothesis's parameters. The
/// kBest best of these get kScanAllSteps steps of all parameters.
constexpr std::size_t kScanFitted = 12, kBest = 2;
constexpr int kScanOwnSteps = 3, kScanAllSteps = 9;
/// So many rounds at most.
constexpr int kScanRounds = 4;

class BlindScan {
 public:
  BlindScan(const Stage& stage, const Hypothesis& h, const fit::Fit& from)
      : stage_(stage), h_(h), from_(from) {
    fit::require_noise_of(stage.events, from);
    for (const auto& e : from.events) states_.push_back(e.state);
    std::vector<char> seen;
    try {
      seen = slopes();
    } catch (const InputError&) {  // a run with slopes takes other steps, and this one cannot be run
      return;
    }
    if (std::ranges::all_of(seen, [](char s) { return s; })) return;
    left_ = left_by({from_.plant, h.conventions}, stage.events, states_);
    for (std::size_t i = 0; i < h.free.size(); ++i)
      if (!seen[i]) blind_.push_back(h.free[i]);
    std::erase_if(blind_, [this](const fit::FreeParameter& f) { return idle(f); });
  }
  /// The best of the values tried. Parameters of the hypothesis are fitted for a few steps; everything else
  /// is as `from` has it.
  [[nodiscard]] std::vector<fit::Fit> best() const {
    std::vector<sim::plant::Plant> plants;
    for (const auto& group : groups())
      for (const double multiple : kMultiples) plants.push_back(multiplied(group, multiple));
    const auto left = left_by_each(plants, h_.conventions, stage_.events, states_);
    std::vector<std::pair<double, sim::plant::Plant>> starts;
    for (std::size_t k = 0; k < plants.size(); ++k)
      if (std::isfinite(left[k]) && (near() || (left[k] < left_ && !alike(left[k], left_))))
        starts.emplace_back(left[k], std::move(plants[k]));
    std::ranges::sort(starts, {}, &std::pair<double, sim::plant::Plant>::first);
    const auto same = [](const auto& a, const auto& b) { return alike(a.first, b.first); };
    starts.erase(std::unique(starts.begin(), starts.end(), same), starts.end());
    std::vector<fit::Fit> tried;
    for (const auto& start : std::span(starts).first(std::min(kScanFitted, starts.size())))
      if (fit::Fit f = beside(start.second); f.failed.empty()) tried.push_back(std::move(f));
    std::ranges::sort(
        tried, [](const fit::Fit& a, const fit::Fit& b) { return fit::gain(b, a, fit::data_cost) > 0; });
    if (tried.size() > kBest) tried.resize(kBest);
    return tried;
  }

 private:
  using Group = std::vector<fit::FreeParameter>;

  /// Beside a model that nearly fits, a value that makes things worse may still be the right one once the
  /// rest has followed; where much is missing, only what helps by itself is gone on with.
  [[nodiscard]] bool near() const { return stage_.fit.misfit() < thresholds::search.nearly_fits; }

  /// For each parameter of the hypothesis, whether any event's answer has a slope along it while instants
  /// stand.
  [[nodiscard]] std::vector<char> slopes() const {
    std::vector<playin::Direction> along;
    for (const fit::FreeParameter& f : h_.free)
      along.push_back({.kind = playin::Direction::Kind::parameter, .parameter = f.id});
    std::vector<char> seen(along.size(), 0);
    for (std::size_t e = 0; e < stage_.events.size(); ++e) {
      const event::FitEvent& event = stage_.events[e];
      const playin::Response r =
          event::play({from_.plant, h_.conventions}, event, states_[e], along, {.instants_stand = true});
      for (std::size_t d = 0; d < along.size(); ++d)
        if (event.collected(r.slopes[d].value, false).squaredNorm() > 0) seen[d] = 1;
    }
    return seen;
  }
  [[nodiscard]] sim::plant::Plant multiplied(const Group& group, double by) const {
    sim::plant::Plant plant = from_.plant;
    for (const fit::FreeParameter& f : group) {
      double& value = sim::plant::parameter_value(plant, f.id);
      const auto range = sim::plant::search_range(sim::plant::parameter_record(plant, f.id), value);
      value = std::clamp(value * by, range.low, range.high);
    }
    return plant;
  }
  /// Whether neither a smaller nor a larger value changes anything.
  [[nodiscard]] bool idle(const fit::FreeParameter& f) const {
    return std::ranges::all_of(std::array{kScanLess, kScanMore}, [&](double by) {
      const double left = left_by({multiplied({f}, by), h_.conventions}, stage_.events, states_);
      return std::abs(left - left_) < thresholds::search.without_slope;
    });
  }
  /// Each parameter by itself, and all parameters of one unit together, so that the points of a curve do not
  /// cross.
  [[nodiscard]] std::vector<Group> groups() const {
    std::vector<Group> all;
    std::map<std::string, Group> by_unit;
    for (const fit::FreeParameter& f : blind_) {
      all.push_back({f});
      by_unit[std::string(sim::plant::parameter_record(from_.plant, f.id).unit)].push_back(f);
    }
    for (auto& [unit, group] : by_unit)
      if (group.size() > 1) all.push_back(std::move(group));
    return all;
  }
  [[nodiscard]] fit::Fit beside(const sim::plant::Plant& plant) const {
    fit::FitOptions o{.lenient = true, .brief = true, .errors = false};
    o.iterations = kScanOwnSteps;
    o.start = states_;
    return fit::fit({plant, h_.conventions}, stage_.events, h_.free, o);
  }

  const Stage& stage_;
  const Hypothesis& h_;
  const fit::Fit& from_;
  std::vector<fit::EventState> states_;
  double left_ = 0;  ///< chi2 where nothing is changed
  std::vector<fit::FreeParameter> blind_;
};

}  // namespace

fit::Fit past_blind(const Stage& stage, const Hypothesis& h, const sim::plant::Plant& believed,
                    fit::Fit from) {
  const auto free = free_of(h, stage.spread);
  for (int round = 0; round < kScanRounds && from.failed.empty(); ++round) {
    fit::Fit best = from;
    for (const fit::Fit& start : BlindScan(stage, h, from).best()) {
      const fit::FitOptions o = fit::continued(
          {.iterations = kScanAllSteps, .lenient = true, .brief = true, .errors = false}, start, free);
      if (fit::Fit f = fit::fit({believed, h.conventions}, stage.events, free, o); fit::better(f, best))
        best = std::move(f);
    }
    const bool worth = fit::gain(from, best) > thresholds::search.worth_a_round;
    from = std::move(best);
    if (!worth) break;
  }
  return from;
}

}  // namespace swingbank::validate::hypothesis
