#include "validate/hypothesis/companions.hpp"

#include <algorithm>

#include "base/in_parallel.hpp"
#include "base/stop_signal.hpp"

namespace swingbank::validate::hypothesis {
namespace {

using Eigen::Index;

/// Step of the finite differences. For the column of an effect: share of the way from its null values to its
/// start values. For the column of one parameter: share of that step.
constexpr double kChangeShare = 0.05;

/// An effect and its columns of the Jacobian: one column for the whole effect and, if it has several
/// parameters, one for each parameter.
struct Companion {
  std::string name;
  std::vector<Index> columns;
};

/// Returns the possible companions of a control in this plant, and appends their changes to `changes`.
std::vector<Companion> companions_in(const BaseModel& base_model, const sim::plant::Plant& plant,
                                     std::vector<reduced::Change>& changes) {
  std::vector<Companion> all;
  BaseModel with_control = base_model;
  with_control.plant = plant;
  for (const Hypothesis& h : with_control.hypotheses()) {
    if ((h.side != Side::machine && h.side != Side::measurement) || h.free.empty()) continue;
    Companion companion{h.name, {}};
    const auto add = [&](const sim::plant::Plant& from, const sim::plant::Plant& to) {
      companion.columns.push_back(static_cast<Index>(changes.size()));
      changes.push_back({from, to});
    };
    sim::plant::Plant begun = h.plant;
    std::vector<double> moves;
    for (std::size_t i = 0; i < h.free.size(); ++i) {
      double& value = parameter_value(begun, h.free[i].id);
      const double null_value = parameter_record(begun, h.free[i].id).null_value, start = h.starts.front()[i];
      value = std::isnan(null_value) ? start : null_value + kChangeShare * (start - null_value);
      moves.push_back(kChangeShare * (std::isnan(null_value) ? start : start - null_value));
    }
    add(plant, begun);
    for (std::size_t i = 0; i < h.free.size() && h.free.size() > 1; ++i) {
      sim::plant::Plant moved = begun;
      parameter_value(moved, h.free[i].id) += kChangeShare * moves[i];
      add(begun, moved);
    }
    all.push_back(std::move(companion));
  }
  return all;
}

}  // namespace

void find_companions(const BaseModel& base_model, const Polish& polish, const Identified& leader,
                     std::vector<Identified>& tried) {
  std::vector<reduced::Change> changes;
  const auto companions = companions_in(base_model, leader.best()->plant, changes);
  if (changes.empty()) return;
  const Polish::Reduced about = polish.linear_about(leader, changes);
  std::vector<Index> every(changes.size());
  for (std::size_t c = 0; c < every.size(); ++c) every[c] = static_cast<Index>(c);
  struct Beside {
    Identified* h;
    std::vector<std::vector<double>> known = {};
    double alone = 0, with_all = 0;  ///< cost of the control alone, and with all changes free
  };
  std::vector<Beside> some;
  for (Identified& h : tried)
    if (h.input() == leader.input() && !h.optima.empty()) some.push_back({&h});
  const auto cost = [&](Beside& b, const std::vector<Index>& freed) {
    const auto found =
        reduced::identify(*about, b.h->input(), b.h->trial, {.draws = 0, .kept = 0, .freed = freed}, b.known);
    if (found.empty()) return std::numeric_limits<double>::infinity();
    b.known = {found.front().values};
    return found.front().cost;
  };
  const auto each = [&](auto act) {
    in_parallel(
        some.size(), [&](std::size_t k) { until_interrupted([&] { act(some[k]); }); }, [](int) {},
        base_model.threads);
  };
  each([&](Beside& b) {
    for (const reduced::Optimum& o : b.h->optima) b.known.push_back(o.values);
    if (const fit::Fit* best = b.h->best()) b.known.push_back(fit::values_of(best->plant, b.h->trial.free));
    b.alone = cost(b, {});
    b.with_all = cost(b, every);
  });
  double least = std::numeric_limits<double>::infinity();
  for (const Beside& b : some) least = std::min(least, b.alone);
  const auto is_worth_it = [&](double left) { return left < least - thresholds::evidence.second; };
  std::erase_if(some, [&](const Beside& b) { return !is_worth_it(b.with_all); });
  each([&](Beside& b) {
    for (const Companion& companion : companions)
      if (const double with = cost(b, companion.columns);
          is_worth_it(with) && least - with > b.h->companion_gain) {
        b.h->companion = companion.name;
        b.h->companion_gain = least - with;
      }
  });
}

}  // namespace swingbank::validate::hypothesis
