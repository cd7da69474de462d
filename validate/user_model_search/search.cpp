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

/// Prior standard deviation of a parameter about the regression's value: a factor e.
constexpr double kRegressionPriorSd = 1.0;
constexpr std::size_t kFitted = 8;     ///< maximum number of candidates that are fitted to the records
constexpr std::size_t kPerSignal = 3;  ///< maximum number of fitted candidates of one signal
constexpr std::size_t kJudged = 3;     ///< number of candidates that are judged on held-out events

/// Returns whether `b` is `a` with additions: every word of `a`'s family is one of `b`'s.
bool within(const LawCandidate& a, const LawCandidate& b) {
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
std::vector<LawCandidate> leading(const std::vector<LawCandidate>& ranked) {
  std::map<std::string, std::size_t> of_signal;
  std::vector<LawCandidate> chosen;
  for (const auto& law : ranked) {
    if (chosen.size() == kFitted || law.explained < thresholds::laws.least_explained) break;
    if (std::ranges::any_of(chosen, [&](const LawCandidate& c) { return within(c, law); })) continue;
    if (of_signal[law.signal]++ < kPerSignal) chosen.push_back(law);
  }
  return chosen;
}
/// Returns the extra evidence that a candidate needs. A time of the record is meaningful only if records
/// start alike. A candidate in proportion to the initial value is more specific than one that is not.
double handicap(const LawCandidate& law) {
  return (law.signal == "time" ? thresholds::laws.own_time.value : 0.0) +
         (law.family.ends_with("in proportion") ? thresholds::laws.in_proportion.value : 0.0);
}

std::string source_of(const event::WhitenedEvents& events) {
  std::string names;
  for (const auto& e : events) names += (names.empty() ? "" : ", ") + e.record.name;
  return "found by swingbank diagnose in " + names;
}

/// Returns the values of `from` and of the block `law` in a plant with this block added.
std::vector<double> values_in(const sim::plant::Plant& from, const sim::plant::Block& law, int block,
                              const std::vector<fit::FreeParameter>& free) {
  std::vector<double> values;
  for (const auto& f : free) {
    const auto [at, index] = f.id;
    values.push_back(at == block ? law.p[static_cast<std::size_t>(index)]
                                 : sim::plant::parameter_value(from, {at > block ? at - 1 : at, index}));
  }
  return values;
}

class Searcher {
 public:
  Searcher(const Unexplained& c, const reduced::FreeInput& input, const event::Progress& report)
      : case_(c), input_(input), report_(report) {}

  LawSearch run() {
    const auto begin = std::chrono::steady_clock::now();
    LawSearch s;
    s.kind = input_.kind;
    const double level = trigger_level(case_.trial.events);
    s.traces = law_traces(case_.model, case_.trial.events, input_, level);
    s.ranked = law_candidates(s.kind, s.traces, level);
    report_progress("", 1, 1);
    const auto tried = leading(s.ranked);
    s.findings.resize(tried.size());
    in_turn("", tried.size(), [&](std::size_t k) { s.findings[k] = fitted(tried[k]); });
    std::erase_if(s.findings, [](const LawFinding& f) { return f.judgement.fit.events.empty(); });
    const auto by_gain = [](const LawFinding& a, const LawFinding& b) {
      if (a.judgement.accepted != b.judgement.accepted) return a.judgement.accepted;
      return a.judgement.gain - handicap(a.law) > b.judgement.gain - handicap(b.law);
    };
    std::ranges::stable_sort(s.findings, by_gain);
    in_turn("unseen events", std::min(kJudged, s.findings.size()),
            [&](std::size_t k) { settle(s.findings[k]); });
    std::ranges::stable_sort(s.findings, by_gain);
    for (LawFinding& f : s.findings) write_out(f, s.traces);
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
    if (report_) report_(event::Phase::laws, item, done, total);
  }

  [[nodiscard]] LawFinding fitted(const LawCandidate& law) const {
    LawFinding f;
    f.law = law;
    f.effect = std::make_shared<const sim::Effect>(
        sim::user_models::make_law(law_toml(law, source_of(case_.trial.events)), law_name(law) + ".toml"));
    hypothesis::Hypothesis& h = f.judgement.hypothesis;
    h.name = law_name(law);
    h.side = law.kind == fit::InputKind::torque ? hypothesis::Side::mechanical : hypothesis::Side::excitation;
    h.conventions = case_.model.conventions;
    int block = 0;
    h.plant = with_law(case_.model.plant, *f.effect, block);
    for (std::size_t i = 0; i < law.parameters.size(); ++i)
      h.free.push_back({{block, static_cast<int>(i)}, kRegressionPriorSd});
    h.starts = {f.effect->default_parameters()};
    const auto free = hypothesis::free_of(h, case_.trial.prior_sd);
    fit::FitOptions o;
    o.iterations = 10;
    o.values = values_in(input_.fit.plant, {f.effect.get(), h.starts.front()}, block, free);
    for (const auto& e : input_.fit.events) o.start.push_back(e.state);
    fit::Fit found = fit::fit(h.under_test(), case_.trial.events, free, o);
    if (!found.failed.empty()) return f;
    f.judgement.fit = std::move(found);
    f.judgement.gain = fit::gain(case_.base, f.judgement.fit, fit::criterion);
    return f;
  }
  void settle(LawFinding& f) const {
    const double left = f.judgement.fit.reduced_chi2();
    if (left > thresholds::laws.judged_below) {
      f.judgement.why_not = fmt::format("reduced chi-square {:.2f}: residual exceeds noise", left);
      return;
    }
    hypothesis::judge(case_.trial, case_.base, case_.held_out_base, f.judgement);
  }
  void write_out(LawFinding& f, const std::vector<LawTrace>& traces) const {
    if (f.judgement.why_not.empty() && !f.judgement.accepted)
      f.judgement.why_not = "not judged: other models fit better";
    const auto& own = f.judgement.hypothesis.free;
    std::vector<fit::FittedParameter> values;
    for (const auto& p : f.judgement.fit.parameters)
      if (p.where.id.block == own.front().id.block) values.push_back(p);
    for (const auto& p : values)
      for (auto& mine : f.law.parameters)
        if (mine.name == p.name) mine.value = p.value;
    std::vector<double> fitted;
    for (const auto& p : f.law.parameters) fitted.push_back(p.value);
    const LawRegression regression(traces);
    f.law.time_series =
        regression.by_event(regression.at_knots(law_time_series(*f.effect, fitted, f.law.kind, traces)));
    f.words = law_words(f.law, values);
    f.judgement.hypothesis.what = f.words;
    f.toml = law_toml(f.law, source_of(case_.trial.events));
  }

  const Unexplained& case_;
  const reduced::FreeInput& input_;
  const event::Progress& report_;
};

}  // namespace

sim::plant::Plant with_law(const sim::plant::Plant& plant, const sim::Effect& effect, int& block) {
  sim::plant::Plant with = plant;
  block = sim::plant::insert_block(with, {&effect, effect.default_parameters()});
  return with;
}

LawSearch search_laws(const Unexplained& case_, const event::Progress& report) {
  const bool torque = case_.torque.reduced_chi2() < case_.field.reduced_chi2();
  const reduced::FreeInput &first = torque ? case_.torque : case_.field,
                           &second = torque ? case_.field : case_.torque;
  const auto explains = [&](const reduced::FreeInput& m) {
    return m.reduced_chi2() <
           std::max(case_.trial.adequate, thresholds::laws.explains * case_.base.reduced_chi2());
  };
  if (!explains(first)) return {};
  LawSearch found = Searcher(case_, first, report).run();
  if (found.found() || !explains(second) ||
      second.reduced_chi2() > thresholds::laws.as_much * first.reduced_chi2())
    return found;
  LawSearch other = Searcher(case_, second, report).run();
  other.seconds += found.seconds;
  return other.found() ? std::move(other) : std::move(found);
}

std::string law_sentence(const LawSearch& search, std::size_t hypotheses) {
  const LawFinding* law = search.found();
  if (!law) return {};
  double before = 0, after = 0;
  const auto& unseen = law->judgement.held_out;
  for (const auto& h : unseen) {
    before += h.before / static_cast<double>(unseen.size());
    after += h.after / static_cast<double>(unseen.size());
  }
  return fmt::format(
      "None of the {} known effects explains the records; {} does: on held-out events the "
      "normalised RMS falls from {:.1f} to {:.2f}.",
      hypotheses, law->words, std::sqrt(before), std::sqrt(after));
}

}  // namespace swingbank::validate::user_model_search
