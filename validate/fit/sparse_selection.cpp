#include "validate/fit/sparse_selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>
#include <set>

#include "validate/fit/interrupted.hpp"
#include "validate/fit/sensitivities.hpp"
#include "validate/fit/sign.hpp"
#include "validate/noise/level.hpp"

namespace swingbank::validate::fit {
namespace {

using Set = std::vector<std::size_t>;  ///< indices of parameters, ascending

constexpr std::size_t kBeam = 60;     ///< number of sets of each size in the beam
constexpr std::size_t kRefitted = 3;  ///< number of sets of each size that are refitted
/// Maximum number of sets of the selected size, and of the next larger size, that are refitted to find
/// equivalent sets.
constexpr std::size_t kTied = 6;

constexpr double kExactly = 1e-6;  ///< relative prior standard deviation that represents a fixed value

const FitOptions kSearch = {.lenient = true};

struct Ranked {
  double cost;
  Set set;
};

class Selection {
 public:
  Selection(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& events,
            const std::vector<FreeParameter>& free, const SparseOptions& options)
      : tested_(tested), events_(events), free_(free), options_(options) {}

  SparseSelection run() {
    try {
      return select();
    } catch (const Interrupted&) {
      if (all_.parameters.empty()) throw;
      throw InterruptedFit{{}, all_};
    }
  }

 private:
  SparseSelection select() {
    fit_all();
    learn_curvature();
    SparseSelection back;
    back.fit = fit_set({}, predict({}, kExactly));
    require(back.fit);
    back.events = events_;
    back.before = back.fit.reduced_chi2();
    back.best = all_.reduced_chi2();
    grow();
    const Promise promise = most_promising();
    if (promise.size == 0 || worth(best_of(promise.size).cost, promise.occam, promise.size) < options_.least)
      return back;
    Set set;
    if (refit({}).cost - penalised(all_) >= options_.each) set = best_set(promise.size);
    if (stopped()) return back;
    drop_idle(set);
    if (set.empty()) return back;
    while (exchange(set)) {
    }
    std::vector<double> rises = evidence(set);
    // A parameter may have been selected only because the unselected ones could move within the tolerance. It
    // is dropped if its evidence is too low with the unselected parameters at their given values.
    for (auto least = std::ranges::min_element(rises); least != rises.end() && *least < options_.each;
         least = std::ranges::min_element(rises)) {
      set = without(set, static_cast<std::size_t>(least - rises.begin()));
      rises = evidence(set);
    }
    if (set.empty()) return back;
    Fit chosen = fit_set(set, predict(set, kExactly), true);
    if (worth(criterion(chosen), 0, set.size()) < options_.least) return back;
    describe(set, rises, std::move(chosen), back);
    return back;
  }
  [[nodiscard]] bool stopped() const { return options_.stop && options_.stop(); }
  void fit_all() {
    if (options_.all) {
      all_ = *options_.all;
      return;
    }
    report(event::Phase::every_parameter, 0, 1);
    all_ = fit(tested_, events_, free_, kSearch);
    require(all_);
    events_ = events_.with(noise::measure_noise_through({all_.plant, tested_.conventions}, all_.events,
                                                        all_.reduced_chi2(), events_));
    all_ = fit(tested_, events_, free_, continued(kSearch, all_, free_));
    require(all_);
  }
  static void require(const Fit& f) {
    if (!f.failed.empty())
      throw InputError(
          {"the model cannot be fitted", "--model", f.failed, "correct the model, or exclude the record"});
  }
  /// Computes the Hessian of the cost at the full fit (all parameters free), and the location of that fit, in
  /// units of the priors.
  void learn_curvature() {
    const auto n = static_cast<Eigen::Index>(free_.size());
    curvature_ = Eigen::MatrixXd::Identity(n, n);  // of the priors
    for (std::size_t e = 0; e < events_.size(); ++e)
      curvature_ += information(event_sensitivities({all_.plant, tested_.conventions}, events_.whitened(e),
                                                    all_.events[e].state, free_));
    at_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& p = all_.parameters[static_cast<std::size_t>(i)];
      at_[i] = moves_by_logarithm(parameter_record(tested_.plant, p.where.id), p.start)
                   ? std::log(p.value / p.start) / p.where.prior_sd
                   : (p.value - p.start) / axis_unit(tested_.plant, p.where);
    }
  }
  /// Prediction of the quadratic model if a set is free and the other parameters are within the tolerance of
  /// a correct value. `excess`: cost minus that of the full fit; `at`: location of the optimum; `occam`: log
  /// determinant of the posterior precision (Fit::occam).
  struct Prediction {
    double excess = 0, occam = 0;
    Eigen::VectorXd at = {};
  };
  [[nodiscard]] Prediction predict(const Set& set) const { return predict(set, options_.right); }
  /// `right`: relative prior standard deviation of the parameters outside `set`.
  [[nodiscard]] Prediction predict(const Set& set, double right) const {
    const Eigen::VectorXd toward = curvature_ * at_;
    Eigen::MatrixXd precision = curvature_;
    double believed = 0;
    for (std::size_t i = 0; i < free_.size(); ++i) {
      if (std::ranges::binary_search(set, i)) continue;
      FreeParameter tightened = free_[i];
      tightened.prior_sd = std::min(tightened.prior_sd, right);
      const double tighter =
          std::pow(axis_unit(tested_.plant, free_[i]) / axis_unit(tested_.plant, tightened), 2);
      precision.diagonal()[static_cast<Eigen::Index>(i)] += tighter - 1;
      believed += std::log(tighter);
    }
    const auto known = precision.ldlt();
    Prediction f{.at = known.solve(toward)};
    f.excess = toward.dot(at_ - f.at);
    f.occam = known.vectorD().array().log().sum() - believed;
    return f;
  }
  /// Fills the beams: the sets of every size with the lowest predicted cost.
  void grow() {
    beams_ = {{{0, {}}}};
    for (std::size_t size = 1; size <= std::min(options_.most, free_.size()); ++size)
      beams_.push_back(grown(beams_.back()));
  }
  /// Returns the best sets that have one parameter more than those of `beam`.
  [[nodiscard]] std::vector<Ranked> grown(const std::vector<Ranked>& beam) const {
    std::vector<Ranked> next;
    std::set<Set> known;
    for (const Ranked& r : beam)
      for (std::size_t i = 0; i < free_.size(); ++i) {
        if (std::ranges::count(r.set, i)) continue;
        Set set = r.set;
        set.insert(std::ranges::upper_bound(set, i), i);
        if (!known.insert(set).second) continue;
        const double cost = predict(set).excess;
        next.push_back({cost, std::move(set)});
      }
    std::ranges::sort(next, {}, &Ranked::cost);
    next.resize(std::min(next.size(), kBeam));
    return next;
  }
  /// Returns the improvement of the criterion over the full fit, minus SparseOptions::each per parameter.
  [[nodiscard]] double worth(double cost, double occam, std::size_t size) const {
    return criterion(all_) - cost - occam - options_.each * static_cast<double>(size);
  }
  /// A size of the set, and Prediction::occam of the best set of this size.
  struct Promise {
    std::size_t size = 0;
    double occam = 0;
  };
  /// Returns the size with the highest predicted worth(); 0 if there are no parameters.
  [[nodiscard]] Promise most_promising() const {
    double most = -std::numeric_limits<double>::infinity();
    Promise best;
    for (std::size_t k = 1; k < beams_.size(); ++k)
      for (std::size_t i = 0; i < std::min(kRefitted, beams_[k].size()); ++i) {
        const Prediction f = predict(beams_[k][i].set);
        if (const double its = worth(penalised(all_) + f.excess, f.occam, k); its > most)
          most = its, best = {k, f.occam};
      }
    return best;
  }
  /// Returns the set with the lowest cost plus SparseOptions::each per parameter. The sizes are tried from
  /// `start` upward and downward. The cost may fall only if two parameters change together, so one size
  /// without a gain does not end the search.
  [[nodiscard]] Set best_set(std::size_t start) const {
    Set set = best_of(start).set;
    double least = refit(set).cost + options_.each * static_cast<double>(start);
    std::size_t tried = 1;
    for (const int step : {1, -1})
      for (auto size = static_cast<std::ptrdiff_t>(start) + step;
           size >= 0 && size < std::ssize(beams_) && std::abs(size - std::ssize(set)) <= 2 && !stopped();
           size += step) {
        // Larger sets cannot gain more than all parameters.
        if (step > 0 && refit(set).cost - penalised(all_) < options_.each) break;
        report(event::Phase::parameter_subsets, ++tried, beams_.size());
        Ranked best = best_of(static_cast<std::size_t>(size));
        if (const double cost = best.cost + options_.each * static_cast<double>(size); cost < least)
          least = cost, set = std::move(best.set);
      }
    return set;
  }
  /// Returns the value of a parameter at the predicted optimum.
  [[nodiscard]] double predicted_value(const Prediction& there, std::size_t i) const {
    const double believed = parameter_value(tested_.plant, free_[i].id),
                 z = there.at[static_cast<Eigen::Index>(i)];
    return moves_by_logarithm(parameter_record(tested_.plant, free_[i].id), believed)
               ? believed * std::exp(z * free_[i].prior_sd)
               : believed + z * axis_unit(tested_.plant, free_[i]);
  }
  /// Fits a set from its predicted optimum `there`. A fit that does not reach the predicted cost is repeated
  /// from the given values.
  [[nodiscard]] Fit fit_set(const Set& set, const Prediction& there, bool errors = false) const {
    FitOptions o = kSearch;
    o.errors = errors;
    std::vector<FreeParameter> some;
    for (const std::size_t i : set) some.push_back(free_[i]);
    if (set.empty()) return fit(tested_, events_, some, o);
    FitOptions from = continued(o, all_, some);
    for (std::size_t i = 0; i < some.size(); ++i) from.values[i] = predicted_value(there, set[i]);
    Fit f = fit(tested_, events_, some, from);
    if (penalised(f) < penalised(all_) + there.excess + options_.each) return f;
    Fit other = fit(tested_, events_, some, o);
    return better(other, f) ? other : f;
  }
  /// Costs of a fit with only the parameters of a set free. `exact`: the other parameters have their given
  /// values; `cost`: estimate if they may move within the tolerance.
  struct Refit {
    double exact = 0, cost = 0;
  };
  /// Fits a set. Each set is fitted once.
  ///
  /// The fit's cost exceeds that of the full fit. This excess becomes smaller if the other parameters may
  /// move, and Refit::cost applies the reduction factor that the quadratic model predicts. For the parameter
  /// of a limit the predicted factor is too small, because a limit that is not reached has no further
  /// influence on the cost. The estimated excess is therefore at least the predicted excess, or the fit's own
  /// excess if that is lower.
  const Refit& refit(const Set& set) const {
    const auto known = refits_.find(set);
    if (known != refits_.end()) return known->second;
    const Prediction fixed = predict(set, kExactly), soft = predict(set);
    const double exact = penalised(fit_set(set, fixed)), most = penalised(all_), over = exact - most;
    Refit r{exact, exact};
    if (over > 0 && fixed.excess > 0)
      r.cost = most + std::max(over * soft.excess / fixed.excess, std::min(over, soft.excess));
    return refits_[set] = r;
  }
  /// Returns the set of this size with the lowest cost. Only sets with the lowest predicted cost are
  /// refitted.
  [[nodiscard]] Ranked best_of(std::size_t size) const {
    Ranked best{std::numeric_limits<double>::infinity(), beams_[size].front().set};
    for (std::size_t k = 0; k < std::min(kRefitted, beams_[size].size()); ++k)
      if (const Refit& r = refit(beams_[size][k].set); r.cost < best.cost)
        best = {r.cost, beams_[size][k].set};
    return best;
  }
  [[nodiscard]] static Set without(Set set, std::size_t i) {
    set.erase(set.begin() + static_cast<std::ptrdiff_t>(i));
    return set;
  }
  /// Drops members of the set that its other members make redundant, the least important first. A set may
  /// contain such members, because only few sets of each smaller size were refitted.
  void drop_idle(Set& set) const {
    while (!set.empty()) {
      std::vector<double> evidence;
      for (std::size_t i = 0; i < set.size(); ++i) {
        evidence.push_back(refit(without(set, i)).cost - refit(set).cost);
        report(event::Phase::subsets_less_one, i + 1, set.size());
      }
      const auto least = std::ranges::min_element(evidence);
      if (*least >= options_.each) break;
      set = without(set, static_cast<std::size_t>(least - evidence.begin()));
    }
  }
  /// Returns the rise of the cost when each member in turn is removed. Parameters outside the set keep their
  /// given values.
  [[nodiscard]] std::vector<double> evidence(const Set& set) const {
    std::vector<double> rises;
    for (std::size_t i = 0; i < set.size(); ++i)
      rises.push_back(refit(without(set, i)).exact - refit(set).exact);
    return rises;
  }
  /// Fills the result from fits in which the other parameters keep their given values.
  void describe(const Set& set, const std::vector<double>& rises, Fit chosen, SparseSelection& back) const {
    const double excess = penalised(back.fit) - penalised(all_);
    for (std::size_t i = 0; i < set.size(); ++i) {
      WrongParameter w;
      w.fit = chosen.parameters[i];
      w.evidence = rises[i];
      w.share = excess > 0 ? std::clamp(w.evidence / excess, 0.0, 1.0) : 0.0;
      w.tied = tied(set, set[i]);
      back.wrong.push_back(std::move(w));
    }
    std::ranges::stable_sort(back.wrong, std::greater<>(), &WrongParameter::evidence);
    for (const auto& [gone, other] : exchanges(set))
      if (other.size() == 2) back.alternatives.push_back({names_of(gone), names_of(other)});
    back.fit = std::move(chosen);
  }
  /// Returns whether a set explains the records as well as the chosen one.
  [[nodiscard]] bool does_as_well(const Set& set, const Set& chosen) const {
    return refit(set).cost - refit(chosen).cost < options_.each;
  }
  /// Returns the names of single parameters that could each replace parameter `which` of the set `set`.
  [[nodiscard]] std::vector<std::string> tied(const Set& set, std::size_t which) const {
    std::vector<std::string> names;
    std::size_t tried = 0;
    for (const Ranked& r : beams_[set.size()]) {
      if (r.set == set || tried == kTied) continue;
      Set other;
      std::ranges::set_difference(r.set, set, std::back_inserter(other));
      Set gone;
      std::ranges::set_difference(set, r.set, std::back_inserter(gone));
      if (other.size() != 1 || gone.size() != 1 || gone.front() != which) continue;
      ++tried;
      if (does_as_well(r.set, set)) names.push_back(name(other.front()));
    }
    return names;
  }
  [[nodiscard]] std::string name(std::size_t i) const {
    return sim::plant::parameter_name(tested_.plant, free_[i].id).text();
  }
  [[nodiscard]] std::vector<std::string> names_of(const Set& set) const {
    std::vector<std::string> names;
    for (const std::size_t i : set) names.push_back(name(i));
    return names;
  }
  /// Replaces members by a pair of parameters, if the pair makes other members redundant. Returns whether the
  /// set changed. Example: the gain after a regulator may compensate for two wrong gains of the regulator,
  /// and the fit then needs a third parameter.
  [[nodiscard]] bool exchange(Set& set) const {
    for (const auto& [gone, other] : exchanges(set)) {
      if (other.size() != 2) continue;
      Set next, kept;
      std::ranges::set_difference(set, gone, std::back_inserter(kept));
      std::ranges::set_union(kept, other, std::back_inserter(next));
      drop_idle(next);
      if (next.size() >= set.size() ||
          refit(next).cost - refit(set).cost >= options_.each * static_cast<double>(set.size() - next.size()))
        continue;
      set = std::move(next);
      return true;
    }
    return false;
  }
  using Exchange = std::pair<Set, Set>;  ///< removed members, replacement
  /// Returns the replacements of members of the set by one or two other parameters. A replacement that
  /// contains a smaller replacement is left out.
  [[nodiscard]] std::vector<Exchange> exchanges(const Set& set) const {
    const double here = predict(set).excess;
    std::vector<Exchange> found;
    const auto is_covered = [&](const Set& gone, const Set& other) {
      return std::ranges::any_of(found, [&](const auto& f) {
        return std::ranges::includes(gone, f.first) && std::ranges::includes(other, f.second);
      });
    };
    for (const std::size_t size : {set.size(), set.size() + 1}) {
      if (size >= beams_.size()) break;
      std::size_t tried = 0;
      for (const Ranked& r : beams_[size]) {
        Set gone, other;
        std::ranges::set_difference(r.set, set, std::back_inserter(other));
        std::ranges::set_difference(set, r.set, std::back_inserter(gone));
        if (gone.empty() || other.size() > 2 || is_covered(gone, other)) continue;
        // Beams are in ascending order of predicted cost, so all later sets are worse.
        if (tried++ == kTied || predict(r.set).excess > here + options_.each) break;
        if (does_as_well(r.set, set)) found.emplace_back(std::move(gone), std::move(other));
      }
    }
    return found;
  }
  void report(event::Phase phase, std::size_t done, std::size_t total) const {
    if (options_.progress) options_.progress(phase, "", static_cast<int>(done), static_cast<int>(total));
  }

  const sim::plant::PlantUnderTest tested_;
  noise::WhitenedEvents events_;
  const std::vector<FreeParameter>& free_;
  const SparseOptions& options_;
  Fit all_;
  Eigen::MatrixXd curvature_;
  Eigen::VectorXd at_;
  std::vector<std::vector<Ranked>> beams_;  ///< [size of the sets]
  mutable std::map<Set, Refit> refits_;     ///< results of refit()
};

}  // namespace

SparseSelection select_parameters(const sim::plant::PlantUnderTest& tested,
                                  const noise::WhitenedEvents& events, const std::vector<FreeParameter>& free,
                                  const SparseOptions& options) {
  return Selection(tested, events, free, options).run();
}

}  // namespace swingbank::validate::fit
