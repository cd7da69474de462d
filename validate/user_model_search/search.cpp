#include "validate/user_model_search/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <set>

#include "base/in_parallel.hpp"
#include "sim/user_models/user_model.hpp"
#include "validate/thresholds/thresholds.hpp"
#include "validate/user_model_search/detail/text.hpp"
#include "validate/user_model_search/detail/time_series.hpp"
#include "validate/user_model_search/detail/traces.hpp"

namespace swingbank::validate::user_model_search {
namespace {

/// Relative prior standard deviation of a parameter about the value of the regression (a factor of e).
constexpr double kRegressionPriorSd = 1.0;
constexpr std::size_t kFitted = 8;     ///< maximum number of candidates that are fitted to the records
constexpr std::size_t kPerSignal = 3;  ///< maximum number of fitted candidates of one signal
constexpr std::size_t kJudged = 3;     ///< maximum number of candidates that are judged on held-out events

/// Returns whether `b` is `a` with additions: every word of `a`'s family is a word of `b`'s family.
bool within(const UserModelCandidate& a, const UserModelCandidate& b) {
  const auto words = [](const std::string& family) {
    std::set<std::string> all;
    for (std::size_t at = 0; at < family.size();) {
      const auto comma = std::min(family.find(", ", at), family.size());
      all.insert(family.substr(at, comma - at));
      at = comma + 2;
    }
    all.erase("static");
    return all;
  };
  return a.signal == b.signal && std::ranges::includes(words(b.family), words(a.family));
}
/// Returns the leading candidates. The number per signal is limited, and candidates that extend a better one
/// are skipped.
std::vector<UserModelCandidate> leading(const std::vector<UserModelCandidate>& ranked) {
  std::map<std::string, std::size_t> of_signal;
  std::vector<UserModelCandidate> chosen;
  for (const auto& user_model : ranked) {
    if (chosen.size() == kFitted || user_model.explained < thresholds::user_models.least_explained) break;
    if (std::ranges::any_of(chosen, [&](const UserModelCandidate& c) { return within(c, user_model); }))
      continue;
    if (of_signal[user_model.signal]++ < kPerSignal) chosen.push_back(user_model);
  }
  return chosen;
}
/// Returns the evidence that is deducted from a candidate in the ranking. A time of the record is meaningful
/// only if all records start at the same time before the event. An output in proportion to the initial active
/// power or field voltage is more specific than a constant one.
double handicap(const UserModelCandidate& user_model) {
  return (user_model.signal == "time" ? thresholds::user_models.own_time.value : 0.0) +
         (user_model.family.ends_with("in proportion") ? thresholds::user_models.in_proportion.value : 0.0);
}

std::string source_of(const noise::WhitenedEvents& events) {
  std::string names;
  for (const auto& e : events) names += (names.empty() ? "" : ", ") + e.record.name;
  return "found by swingbank diagnose in " + names;
}

/// Returns the values of the parameters `free` in a plant with the added block `user_model` at index `block`:
/// those of this block from `user_model`, the others from the plant `from`.
std::vector<double> values_in(const sim::plant::Plant& from, const sim::plant::Block& user_model, int block,
                              const std::vector<fit::FreeParameter>& free) {
  std::vector<double> values;
  for (const auto& f : free) {
    const auto [at, index] = f.id;
    values.push_back(at == block ? user_model.p[static_cast<std::size_t>(index)]
                                 : sim::plant::parameter_value(from, {at > block ? at - 1 : at, index}));
  }
  return values;
}

class Searcher {
 public:
  Searcher(const Unexplained& c, const reduced::FreeInput& input, const event::Progress& report)
      : case_(c), input_(input), report_(report) {}

  UserModelSearch run() {
    const auto begin = std::chrono::steady_clock::now();
    UserModelSearch s;
    s.kind = input_.kind;
    const double level = trigger_level(case_.trial.events);
    s.traces = user_model_traces(case_.model, case_.trial.events, input_, level);
    s.ranked = user_model_candidates(s.kind, s.traces, level);
    report_progress("", 1, 1);
    const auto tried = leading(s.ranked);
    s.findings.resize(tried.size());
    in_turn("", tried.size(), [&](std::size_t k) { s.findings[k] = fitted(tried[k]); });
    std::erase_if(s.findings, [](const UserModelFinding& f) { return f.judgement.fit.events.empty(); });
    const auto by_gain = [](const UserModelFinding& a, const UserModelFinding& b) {
      if (a.judgement.accepted != b.judgement.accepted) return a.judgement.accepted;
      return a.judgement.gain - handicap(a.user_model) > b.judgement.gain - handicap(b.user_model);
    };
    std::ranges::stable_sort(s.findings, by_gain);
    in_turn("unseen events", std::min(kJudged, s.findings.size()),
            [&](std::size_t k) { settle(s.findings[k]); });
    std::ranges::stable_sort(s.findings, by_gain);
    for (UserModelFinding& f : s.findings) write_out(f, s.traces);
    s.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return s;
  }

 private:
  template <class Work>
  void in_turn(const std::string& item, std::size_t n, Work work) {
    in_parallel(
        n, work, [&](int done) { report_progress(item, done, static_cast<int>(n)); }, case_.threads);
  }
  void report_progress(const std::string& item, int done, int total) const {
    if (report_) report_(event::Phase::user_models, item, done, total);
  }

  [[nodiscard]] UserModelFinding fitted(const UserModelCandidate& user_model) const {
    UserModelFinding f;
    f.user_model = user_model;
    f.effect = std::make_shared<const sim::Effect>(sim::user_models::make_user_model(
        user_model_toml(user_model, source_of(case_.trial.events)), user_model_name(user_model) + ".toml"));
    hypothesis::Hypothesis& h = f.judgement.hypothesis;
    h = hypothesis::unchanged(case_.model.under_test());
    h.name = user_model_name(user_model);
    h.side = user_model.kind == fit::InputKind::torque ? hypothesis::Side::mechanical
                                                       : hypothesis::Side::excitation;
    const int block = sim::plant::insert_block(h.plant, {f.effect.get(), f.effect->default_parameters()});
    for (std::size_t i = 0; i < user_model.parameters.size(); ++i)
      h.free.push_back({{block, static_cast<int>(i)}, kRegressionPriorSd});
    h.starts = {f.effect->default_parameters()};
    const auto free = hypothesis::free_of(h, case_.trial.prior_sd);
    fit::FitOptions o = fit::continued({.iterations = 10}, input_.fit, {});
    o.values = values_in(input_.fit.plant, {f.effect.get(), h.starts.front()}, block, free);
    fit::Fit found = fit::fit(h.under_test(), case_.trial.events, free, o);
    if (!found.failed.empty()) return f;
    f.judgement.fit = std::move(found);
    f.judgement.gain = fit::gain(case_.base, f.judgement.fit, fit::criterion);
    return f;
  }
  void settle(UserModelFinding& f) const {
    const double left = f.judgement.fit.reduced_chi2();
    if (left > thresholds::user_models.judged_below) {
      f.judgement.why_not = fmt::format("reduced chi-square {:.2f}: residual exceeds noise", left);
      return;
    }
    hypothesis::judge(case_.trial, case_.base, case_.held_out_base, f.judgement);
  }
  void write_out(UserModelFinding& f, const std::vector<UserModelTrace>& traces) const {
    if (f.judgement.why_not.empty() && !f.judgement.accepted)
      f.judgement.why_not = "not tested on held-out events: other models fit better";
    const auto& own = f.judgement.hypothesis.free;
    std::vector<fit::FittedParameter> values;
    for (const auto& p : f.judgement.fit.parameters)
      if (p.where.id.block == own.front().id.block) values.push_back(p);
    for (const auto& p : values)
      for (auto& mine : f.user_model.parameters)
        if (mine.name == p.name) mine.value = p.value;
    std::vector<double> fitted;
    for (const auto& p : f.user_model.parameters) fitted.push_back(p.value);
    const UserModelRegression regression(traces);
    f.user_model.time_series = regression.by_event(
        regression.at_knots(user_model_time_series(*f.effect, fitted, f.user_model.kind, traces)));
    f.words = user_model_words(f.user_model, values);
    f.judgement.hypothesis.what = f.words;
    f.toml = user_model_toml(f.user_model, source_of(case_.trial.events));
  }

  const Unexplained& case_;
  const reduced::FreeInput& input_;
  const event::Progress& report_;
};

}  // namespace

UserModelSearch search_user_models(const Unexplained& case_, const event::Progress& report) {
  const bool torque = case_.torque.reduced_chi2() < case_.field.reduced_chi2();
  const reduced::FreeInput &first = torque ? case_.torque : case_.field,
                           &second = torque ? case_.field : case_.torque;
  const auto explains = [&](const reduced::FreeInput& m) {
    return m.reduced_chi2() <
           std::max(case_.trial.adequate, thresholds::user_models.explains * case_.base.reduced_chi2());
  };
  if (!explains(first)) return {};
  UserModelSearch found = Searcher(case_, first, report).run();
  if (found.found() || !explains(second) ||
      second.reduced_chi2() > thresholds::user_models.as_much * first.reduced_chi2())
    return found;
  UserModelSearch other = Searcher(case_, second, report).run();
  other.seconds += found.seconds;
  return other.found() ? std::move(other) : std::move(found);
}

std::string user_model_sentence(const UserModelSearch& search, std::size_t hypotheses) {
  const UserModelFinding* user_model = search.found();
  if (!user_model) return {};
  const auto [before, after] = hypothesis::mean_reduced_chi2(user_model->judgement.held_out);
  return fmt::format(
      "None of the {} known effects explains the records. A user-defined model does: {}. On held-out "
      "events the normalised RMS falls from {:.1f} to {:.2f}.",
      hypotheses, user_model->words, std::sqrt(before), std::sqrt(after));
}

}  // namespace swingbank::validate::user_model_search
