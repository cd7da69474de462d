#include "validate/diagnose/detail/report_user_models.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/json.hpp"
#include "validate/user_model_search/regression.hpp"

namespace swingbank::validate::diagnose {
namespace {

using report::Ink;

std::string input_name(const user_model_search::UserModelSearch& s) {
  return s.kind == fit::InputKind::torque ? "inferred torque" : "inferred field voltage";
}

void add_scatters(const Diagnosis& d, report::Document& page) {
  const user_model_search::UserModelSearch& s = d.user_models;
  const user_model_search::UserModelRegression regression(s.traces);
  page.add(report::Begin{report::Begin::Layout::row});
  for (std::size_t signal = 0; signal < user_model_search::kUserModelSignals.size(); ++signal) {
    user_model_search::TimeSeries time_series;
    for (const auto& t : s.traces) time_series.push_back(t.signal[signal]);
    const auto x = regression.by_event(regression.at_knots(time_series));
    report::Scatter plot{std::string(user_model_search::kUserModelSignals[signal].expression),
                         std::string(user_model_search::kUserModelSignals[signal].expression) + " [pu]",
                         input_name(s) + " [pu]",
                         {{"inferred", Ink::inferred, {}}}};
    if (s.found()) plot.groups.push_back({"user-defined model", Ink::fitted, {}});
    for (std::size_t e = 0; e < s.traces.size(); ++e)
      for (std::size_t k = 0; k < x[e].size(); ++k) {
        plot.groups[0].points.emplace_back(x[e][k], s.traces[e].input[k]);
        if (s.found()) plot.groups[1].points.emplace_back(x[e][k], s.found()->user_model.time_series[e][k]);
      }
    page.add(std::move(plot));
  }
  page.add(report::End{});
}
void add_time_series(const Diagnosis& d, report::Document& page) {
  const user_model_search::UserModelSearch& s = d.user_models;
  for (std::size_t e = 0; e < s.traces.size(); ++e) {
    const std::string& name = d.events[e].record.name;
    report::Curves c{name + ": " + input_name(s), "pu", name + " user-defined model", s.traces[e].knots};
    c.series.push_back({"inferred", Ink::inferred, s.traces[e].input});
    if (s.found())
      c.series.push_back({"user-defined model", Ink::fitted, s.found()->user_model.time_series[e]});
    page.add(std::move(c));
  }
}
std::string unseen_words(const user_model_search::UserModelFinding& f) {
  double worst = 0;
  for (const auto& u : f.judgement.held_out) worst = std::max(worst, std::sqrt(u.after));
  return f.judgement.held_out.empty() ? "–" : fmt::format("≤ {:.2f} ×", worst);
}

nlohmann::json finding_json(const user_model_search::UserModelFinding& f) {
  const hypothesis::Judgement& j = f.judgement;
  nlohmann::json user_model = {{"name", j.hypothesis.name},
                               {"words", f.words},
                               {"family", f.user_model.family},
                               {"signal", f.user_model.signal},
                               {"accepted", j.accepted},
                               {"why_not", j.why_not},
                               {"evidence", j.gain},
                               {"normalised_rms", std::sqrt(j.fit.reduced_chi2())},
                               {"explained_of_input", f.user_model.explained},
                               {"file", f.toml},
                               {"parameters", nlohmann::json::array()},
                               {"unseen", nlohmann::json::array()}};
  for (const auto& p : j.fit.parameters)
    if (p.where.id.block == j.hypothesis.free.front().id.block)
      user_model["parameters"].push_back(
          {{"name", p.name}, {"unit", p.unit}, {"value", p.value}, {"low_95", p.low}, {"high_95", p.high}});
  for (const auto& u : j.held_out)
    user_model["unseen"].push_back({{"record", u.record},
                                    {"normalised_rms_before", std::sqrt(u.before)},
                                    {"normalised_rms_after", std::sqrt(u.after)}});
  return user_model;
}

}  // namespace

void user_models_on_page(const Diagnosis& d, report::Document& page) {
  const user_model_search::UserModelSearch& s = d.user_models;
  if (s.kind == fit::InputKind::none) return;
  page.section("User-defined model");
  page.text(
      fmt::format("No known effect explains the records. The charts show the {} over time and against "
                  "every possible input signal. {} model structures (proportional, lag, washout, limit, dead "
                  "band, polynomial, periodic, or triggered by time or by voltage) were ranked by "
                  "regression on this input. The leading {} were fitted to the records. A user-defined "
                  "model is accepted only if it predicts held-out events.",
                  input_name(s), s.ranked.size(), s.findings.size()));
  if (const user_model_search::UserModelFinding* f = s.found())
    page.note(fmt::format("Found: {}.", f->words));
  else
    page.note("No user-defined model predicts held-out events; none is accepted.");
  add_time_series(d, page);
  add_scatters(d, page);
  report::Table table{"",
                      {"model", "explained share of the inferred input", "evidence", "normalised RMS",
                       "held-out events", "judgement", "description"},
                      {}};
  for (const auto& f : s.findings)
    table.rows.push_back({f.judgement.hypothesis.name, fmt::format("{:.0f} %", 100 * f.user_model.explained),
                          fmt::format("{:.1f}", f.judgement.gain),
                          fmt::format("{:.2f} ×", std::sqrt(f.judgement.fit.reduced_chi2())), unseen_words(f),
                          f.judgement.accepted ? "accepted" : f.judgement.why_not, f.words});
  if (!table.rows.empty()) page.add(table);
}

nlohmann::json user_models_json(const Diagnosis& d) {
  const user_model_search::UserModelSearch& s = d.user_models;
  if (s.kind == fit::InputKind::none) return nullptr;
  nlohmann::json j = {{"input", s.kind == fit::InputKind::torque ? "torque" : "field_voltage"},
                      {"found", s.found() ? nlohmann::json(s.found()->judgement.hypothesis.name) : nullptr},
                      {"ranked", s.ranked.size()},
                      {"seconds", s.seconds},
                      {"fitted", nlohmann::json::array()}};
  for (const auto& f : s.findings) j["fitted"].push_back(finding_json(f));
  return j;
}

std::string user_models_text(const Diagnosis& d) {
  const user_model_search::UserModelSearch& s = d.user_models;
  if (s.kind == fit::InputKind::none) return {};
  std::string text =
      fmt::format("\nUser-defined models for the {} ({} ranked; evidence, reduced chi-square, judgement):\n",
                  input_name(s), s.ranked.size());
  for (const auto& f : s.findings)
    text += fmt::format("  {:>10.1f} {:>8.3f}  {}: {}\n", f.judgement.gain, f.judgement.fit.reduced_chi2(),
                        f.judgement.accepted ? "accepted" : f.judgement.why_not, f.words);
  if (!s.found()) text += "  none predicts held-out events\n";
  return text;
}

}  // namespace swingbank::validate::diagnose
