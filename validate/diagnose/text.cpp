#include "validate/diagnose/text.hpp"

#include <fmt/format.h>

#include "validate/diagnose/detail/false_positives.hpp"
#include "validate/diagnose/detail/report_user_models.hpp"
#include "validate/diagnose/detail/verdict.hpp"
#include "validate/report/document.hpp"
#include "validate/report/figures.hpp"
#include "validate/thresholds/list.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::diagnose {
namespace {

void add_inputs(const Diagnosis& d, std::string& text) {
  if (d.torque.fit.events.empty() || d.field.fit.events.empty()) return;  // interrupted before the inference
  text += fmt::format(
      "\nReduced chi-square after the complete refit (noise: 1): {:.2f}; with an unknown mechanical torque: {:.2f}; "
      "with an unknown field voltage: {:.2f}.\n",
      d.base.reduced_chi2(), d.torque.reduced_chi2(), d.field.reduced_chi2());
}
void add_probabilities(const Diagnosis& d, std::string& text) {
  if (d.probabilities.empty()) return;
  text += fmt::format("\n{}\nProbability of each explanation, 'none of these' included:\n", tempering_note());
  const std::size_t set = hypothesis::credible(d.probabilities);
  for (std::size_t i = 0; i < d.probabilities.size(); ++i)
    if (i < set || d.probabilities[i].probability >= kShownFrom)
      text += fmt::format(
          "  {:>6}  {}{}\n", report::probability_text(d.probabilities[i].probability),
          d.probabilities[i].name,
          i < set ? ""
                  : fmt::format("  (outside the {:.0f} % credible set)", 100 * thresholds::posterior.set));
  if (d.would_decide.next.empty()) return;
  text += fmt::format(
      "\nPossible next measurements, with the expected number of remaining candidates (now {:.0f}):\n",
      d.would_decide.now);
  for (const auto& n : d.would_decide.next) text += fmt::format("  {:>6.1f}  {}\n", n.expected, n.what);
}
void add_hypotheses(const Diagnosis& d, std::string& text) {
  text += fmt::format(
      "\nred. chi2: reduced chi-square; held-out red. chi2: mean over the held-out events\n"
      "{:<18} {:<12} {:>12} {:>10} {:>42}  {}\n",
      "hypothesis", "side", "evidence", "red. chi2", "held-out red. chi2: refitted → with effect",
      "judgement");
  for (std::size_t i = 0; i < d.ranked.size() && i < kHypothesesShown; ++i) {
    const hypothesis::Judgement& j = d.ranked[i];
    const auto [before, after] = hypothesis::mean_reduced_chi2(j.held_out);
    text += fmt::format("{:<18} {:<12} {:>12.1f} {:>10} {:>42}  {}\n", hypothesis::full_name(j.hypothesis),
                        hypothesis::side_name(j.hypothesis.side), j.gain,
                        j.fitted ? fmt::format("{:.3f}", j.fit.reduced_chi2()) : "",
                        j.held_out.empty() ? "" : fmt::format("{:.2f} → {:.3f}", before, after),
                        j.accepted ? "accepted" : j.why_not);
  }
  if (d.ranked.size() > kHypothesesShown)
    text += fmt::format("and {} more of lower rank\n", d.ranked.size() - kHypothesesShown);
}
void add_parameters(const Diagnosis& d, std::string& text) {
  const bool named = !d.ranked.empty() && d.ranked.front().accepted;
  const user_model_search::UserModelFinding* user_model = named ? nullptr : d.user_models.found();
  if (!named && !user_model && !d.ruling.adequate) {
    text += "\nThe fitted values are not shown: the residual exceeds noise, so they are biased.\n";
    return;
  }
  const fit::Fit& fit = named ? d.ranked.front().fit : user_model ? user_model->judgement.fit : d.base;
  text += fmt::format("\n{:<10} {:<10} {:>12} {:>12} {:>26} {:>6}\n", "block", "parameter", "model", "fitted",
                      "95 % interval", "unit");
  for (const auto& p : fit.parameters)
    text += fmt::format("{:<10} {:<10} {:>12.5g} {:>12.5g} {:>26} {:>6}{}\n", p.block, p.name, p.start,
                        p.value, fmt::format("{:.4g} to {:.4g}", p.low, p.high), p.unit,
                        p.at_bound ? "  (at its bound: interval not valid)"
                        : p.decided < thresholds::parameters.identified ? "  (not identified)"
                                                                        : "");
}

}  // namespace

std::string diagnosis_text(const Diagnosis& d) {
  std::string text = d.sentence + "\n" + false_positive_note() + "\n";
  add_probabilities(d, text);
  if (const auto wrong = wrong_parameters(d)) text += "\n" + calibrate::wrong_text(*wrong);
  add_inputs(d, text);
  add_hypotheses(d, text);
  text += user_models_text(d);
  add_parameters(d, text);
  text += fmt::format("\n{} events, {:.1f} s\n", d.events.size(), d.seconds);
  return text;
}

std::string thresholds_text() {
  report::Table table{"Thresholds", {"threshold", "value", "unit", "why"}, {}};
  for (const auto& t : thresholds::all_thresholds())
    table.rows.push_back(
        {std::string(t.name), fmt::format("{:g}", t.value), std::string(t.unit), std::string(t.why)});
  return report::padded(table, table.header.size());
}

}  // namespace swingbank::validate::diagnose
