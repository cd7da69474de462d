#include "validate/fit/fewest.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "validate/fit/noise.hpp"
#include "validate/fit/slopes.hpp"

namespace swingbank::validate::fit {
namespace {

using Set = std::vector<std::size_t>;  ///< of parameters, in order

constexpr std::size_t kBeam = 60;     ///< sets of each size that are kept
constexpr std::size_t kRefitted = 3;  ///< sets of each size that are refitted
constexpr std::size_t kTied = 6;      ///< sets of the size that is taken that are refitted to find ties

struct Ranked {
  double cost;
  Set set;
};

class Selection {
 public:
  Selection(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
            const std::vector<FreeParameter>& free, const FewestOptions& options)
      : tested_(tested), events_(events), free_(free), options_(options) {}

  Fewest run() {
    fit_all();
    learn_curvature();
    Fewest back;
    Fit chosen = refit({});
    back.before = chosen.misfit();
    back.best = all_.misfit();
    Set set;
    const double nothing = penalised(chosen), most = penalised(all_);
    double taken = nothing;
    std::vector<Ranked> beam = {{0, {}}}, of_size;
    for (std::size_t size = 1; size <= std::min(options_.most, free_.size()); ++size) {
      if (options_.stop && options_.stop()) return back;
      if (taken - most < options_.each) break;  // every other parameter together earns no more
      beam = grown(beam);
      auto [fit, best] = best_of(beam, kRefitted);
      report("sets of parameters", size, options_.most);
      // a set of this size may look poor where the next one holds two that work together
      if (const double gain = taken - penalised(fit);
          gain > options_.each * static_cast<double>(size - set.size())) {
        taken = penalised(fit);
        chosen = std::move(fit);
        set = std::move(best);
        of_size = beam;
      } else if (size >= set.size() + 2) {
        break;
      }
    }
    chosen = refit(set, true);
    describe(set, chosen, of_size, nothing - most, back);
    back.fit = std::move(chosen);
    back.events = events_;
    return back;
  }

 private:
  void fit_all() {
    report("every parameter", 0, 1);
    all_ = fit(tested_, events_, free_);
    require(all_);
    events_ = events_.with(measure_noise_through(all_, tested_.conventions, events_));
    all_ = fit(tested_, events_, free_, continued({}, all_, free_));
    require(all_);
  }
  static void require(const Fit& f) {
    if (!f.failed.empty())
      throw InputError(
          {"the model cannot be fitted", "the model", f.failed, "correct the model or leave the record out"});
  }
  /// Curvature where all are free, and where that is, in units of what is believed of the parameters.
  void learn_curvature() {
    const auto n = static_cast<Eigen::Index>(free_.size());
    curvature_ = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t e = 0; e < events_.size(); ++e)
      curvature_ += information(
          event_slopes({all_.plant, tested_.conventions}, events_.whitened(e), all_.events[e].state, free_));
    at_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& p = all_.parameters[static_cast<std::size_t>(i)];
      at_[i] = p.start > 0 ? std::log(p.value / p.start) / p.where.spread
                           : (p.value - p.start) / axis_unit(tested_.plant, p.where);
    }
  }
  /// By how much the cost exceeds that with all free, if only these move: on the curvature.
  [[nodiscard]] double excess(const Set& set) const {
    const auto k = static_cast<Eigen::Index>(set.size());
    const Eigen::VectorXd toward = curvature_ * at_;
    double cost = at_.dot(toward);
    if (k == 0) return cost;
    Eigen::MatrixXd own(k, k);
    Eigen::VectorXd along(k);
    for (Eigen::Index i = 0; i < k; ++i) {
      const auto a = static_cast<Eigen::Index>(set[static_cast<std::size_t>(i)]);
      along[i] = toward[a];
      for (Eigen::Index j = 0; j < k; ++j)
        own(i, j) = curvature_(a, static_cast<Eigen::Index>(set[static_cast<std::size_t>(j)]));
      own(i, i) += 1;
    }
    return cost - along.dot(own.ldlt().solve(along));
  }
  /// The best sets with one more parameter.
  [[nodiscard]] std::vector<Ranked> grown(const std::vector<Ranked>& beam) const {
    std::vector<Ranked> next;
    std::set<Set> known;
    for (const Ranked& r : beam)
      for (std::size_t i = 0; i < free_.size(); ++i) {
        if (std::ranges::count(r.set, i)) continue;
        Set set = r.set;
        set.insert(std::ranges::upper_bound(set, i), i);
        if (!known.insert(set).second) continue;
        const double cost = excess(set);
        next.push_back({cost, std::move(set)});
      }
    std::ranges::sort(next, {}, &Ranked::cost);
    next.resize(std::min(next.size(), kBeam));
    return next;
  }
  [[nodiscard]] std::vector<FreeParameter> members(const Set& set) const {
    std::vector<FreeParameter> some;
    for (const std::size_t i : set) some.push_back(free_[i]);
    return some;
  }
  /// Fits these alone, from the better of the believed values and those with all free.
  [[nodiscard]] Fit refit(const Set& set, bool errors = false) const {
    FitOptions o;
    o.errors = errors;
    const auto some = members(set);
    Fit from_belief = fit(tested_, events_, some, o);
    if (set.empty()) {
      require(from_belief);
      return from_belief;
    }
    Fit from_all = fit(tested_, events_, some, continued(o, all_, some));
    return better(from_all, from_belief) ? from_all : from_belief;
  }
  [[nodiscard]] std::pair<Fit, Set> best_of(const std::vector<Ranked>& beam, std::size_t count) const {
    std::pair<Fit, Set> best;
    best.first.failed = "not fitted";
    for (std::size_t k = 0; k < std::min(count, beam.size()); ++k)
      if (Fit f = refit(beam[k].set); better(f, best.first)) best = {std::move(f), beam[k].set};
    return best;
  }
  void describe(const Set& set, const Fit& chosen, const std::vector<Ranked>& of_size, double excess_of_model,
                Fewest& back) const {
    for (std::size_t i = 0; i < set.size(); ++i) {
      Set less = set;
      less.erase(less.begin() + static_cast<std::ptrdiff_t>(i));
      WrongParameter w;
      w.fit = chosen.parameters[i];
      w.evidence = gain(refit(less), chosen);
      w.share = excess_of_model > 0 ? std::clamp(w.evidence / excess_of_model, 0.0, 1.0) : 0.0;
      w.tied = tied(set, set[i], chosen, of_size);
      back.wrong.push_back(std::move(w));
      report("sets of parameters without one", i + 1, set.size());
    }
    std::ranges::stable_sort(back.wrong, std::greater<>(), &WrongParameter::evidence);
  }
  /// What would do in place of one of the set.
  [[nodiscard]] std::vector<std::string> tied(const Set& set, std::size_t which, const Fit& chosen,
                                              const std::vector<Ranked>& of_size) const {
    std::vector<std::string> names;
    std::size_t tried = 0;
    for (const Ranked& r : of_size) {
      if (r.set == set || tried == kTied) continue;
      Set other;
      std::ranges::set_difference(r.set, set, std::back_inserter(other));
      Set gone;
      std::ranges::set_difference(set, r.set, std::back_inserter(gone));
      if (other.size() != 1 || gone.size() != 1 || gone.front() != which) continue;
      ++tried;
      if (gain(refit(r.set), chosen) < options_.each)
        names.push_back(sim::plant::parameter_name(tested_.plant, free_[other.front()].id).text());
    }
    return names;
  }
  void report(const std::string& what, std::size_t done, std::size_t total) const {
    if (options_.progress) options_.progress(what, static_cast<int>(done), static_cast<int>(total));
  }

  const sim::plant::PlantUnderTest tested_;
  event::WhitenedEvents events_;
  const std::vector<FreeParameter>& free_;
  const FewestOptions& options_;
  Fit all_;
  Eigen::MatrixXd curvature_;
  Eigen::VectorXd at_;
};

}  // namespace

Fewest fewest(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
              const std::vector<FreeParameter>& free, const FewestOptions& options) {
  return Selection(tested, events, free, options).run();
}

}  // namespace swingbank::validate::fit
