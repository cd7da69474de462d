// Other optima of an effect, sought far from where its fit ended: a block's poles and zeros may change
// places, and no fit leads from one such optimum to another.
#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "base/problem.hpp"
#include "validate/fit/rao_score.hpp"
#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// So many draws about the fitted values are looked at. The best kLooks of them are fitted for kLookSteps,
/// and the best kLooksOn of these go on for kLookOnSteps.
constexpr std::size_t kDrawsAbout = 40, kLooks = 4, kLooksOn = 2;
constexpr int kLookSteps = 6, kLookOnSteps = 12;

class Basins {
 public:
  Basins(const Stage& stage, const Judgement& j, std::span<const sim::plant::Plant> rivals)
      : stage_(stage),
        rivals_(rivals),
        h_(j.hypothesis),
        from_(j.fit),
        own_(h_.free.size() - stage.own.size()) {}

  /// The best fit that was found elsewhere, without errors.
  [[nodiscard]] std::optional<fit::Fit> best() const {
    Hypothesis about = h_;
    about.plant = from_.plant;
    std::vector<fit::Fit> tried;
    auto draws = further_draws(about, own_, kDrawsAbout, 0);
    const auto fitted_values = fit::values_of(from_.plant, h_.free);
    for (const sim::plant::Plant& rival : rivals_)
      if (auto values = by_name(h_, fitted_values, rival); values != fitted_values)
        draws.push_back(std::move(values));
    for (const sim::plant::Plant& plant : promising(draws))
      tried.push_back(fitted(plant, from_, kLookSteps, kLookSteps + kLookOnSteps));
    std::ranges::sort(tried, fit::better);
    if (tried.size() > kLooksOn) tried.resize(kLooksOn);
    for (fit::Fit& f : tried)
      if (f.failed.empty()) f = fitted(f.plant, f, kLookOnSteps, kLookOnSteps);
    const auto least = std::ranges::min_element(tried, fit::better);
    if (least == tried.end() || !least->failed.empty()) return std::nullopt;
    return std::move(*least);
  }

 private:
  /// The fit without the effect's own parameters: what is left follows a change of these, as far as it is
  /// linear.
  [[nodiscard]] fit::Fit of_others() const {
    fit::Fit others = from_;
    std::erase_if(others.parameters, [&](const fit::FittedParameter& p) {
      return std::ranges::any_of(std::span(h_.free).first(own_),
                                 [&](const fit::FreeParameter& f) { return f.id == p.where.id; });
    });
    return others;
  }
  /// Those of the draws that raise chi2 least once everything else has followed, the best first.
  [[nodiscard]] std::vector<sim::plant::Plant> promising(
      const std::vector<std::vector<double>>& draws) const {
    std::vector<sim::plant::Plant> plants(draws.size(), from_.plant);
    for (std::size_t k = 0; k < draws.size(); ++k)
      for (std::size_t i = 0; i < own_; ++i)
        sim::plant::parameter_value(plants[k], h_.free[i].id) = draws[k][i];
    const auto changes = score_.changes_to(plants, h_.conventions);
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < plants.size(); ++k)
      if (changes[k] && changes[k]->square > 0) order.push_back(k);
    std::ranges::sort(order, {}, [&](std::size_t k) { return changes[k]->rise(); });
    if (order.size() > kLooks) order.resize(kLooks);
    std::vector<sim::plant::Plant> best;
    for (const std::size_t k : order) best.push_back(std::move(plants[k]));
    return best;
  }
  /// Fits everything from the values of `plant` and the events' states of `at`. It ends early where it would
  /// not get below the fit that is there in so many steps.
  [[nodiscard]] fit::Fit fitted(const sim::plant::Plant& plant, const fit::Fit& at, int steps,
                                int left) const {
    fit::FitOptions o = fit::continued({.iterations = steps, .lenient = true, .brief = true}, at, free_);
    o.values = fit::values_of(plant, free_);
    o.errors = false;
    o.goal = {fit::penalised(from_), left};
    return fit::fit(h_.under_test(), stage_.events, free_, o);
  }

  const Stage& stage_;
  std::span<const sim::plant::Plant> rivals_;
  const Hypothesis& h_;
  const fit::Fit& from_;
  const std::size_t own_;  ///< the effect's own free parameters, which come first
  const std::vector<fit::FreeParameter> free_ = free_of(h_, stage_.spread);
  const fit::Fit others_ = of_others();
  const sim::plant::Plant believed_ = [this] {
    sim::plant::Plant plant = from_.plant;
    for (const auto& p : others_.parameters) sim::plant::parameter_value(plant, p.where.id) = p.start;
    return plant;
  }();
  const fit::ScoreTest score_{stage_.events, {believed_, h_.conventions}, others_, true};
};

}  // namespace

void try_basins(const Stage& stage, Judgement& j, std::span<const sim::plant::Plant> rivals) {
  if (!j.hypothesis.drawn || !j.fit.failed.empty()) return;
  std::optional<fit::Fit> found;
  try {
    found = Basins(stage, j, rivals).best();
  } catch (const InputError&) {  // a run with slopes takes other steps, and this one cannot be run
  }
  if (!found || !fit::better(*found, j.fit)) return;
  auto known = with_errors(stage, j.hypothesis, *found);
  if (known && fit::gain(j.fit, *known, fit::criterion) > 0) j.fit = std::move(*known);
}

}  // namespace swingbank::validate::hypothesis
