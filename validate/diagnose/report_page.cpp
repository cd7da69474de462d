// The page of a diagnosis: verdict, worst event, side, candidates, events, provenance.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/json.hpp"
#include "base/shell_word.hpp"
#include "sim/plant/parameter_id.hpp"
#include "validate/compare/error_map_table.hpp"
#include "validate/compare/first_screen.hpp"
#include "validate/compare/page_parts.hpp"
#include "validate/diagnose/detail/false_positives.hpp"
#include "validate/diagnose/detail/report_user_models.hpp"
#include "validate/diagnose/detail/verdict.hpp"
#include "validate/diagnose/report.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::validate::diagnose {
namespace {

constexpr const char *kTorque = "Inferred missing torque, added to Tm",
                     *kField = "Inferred missing field voltage, added to Efd";
constexpr std::size_t kLeastProbable = 4;  // minimum number of plotted explanations

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }
std::string value_text(double v) { return std::isfinite(v) ? fmt::format("{:.4g}", v) : "–"; }

/// Returns the verdict in at most eight words.
std::string headline(const Diagnosis& d) {
  switch (d.verdict) {
    case Verdict::adequate:
      return !d.wrong ? "No component is missing"
                      : fmt::format("No component is missing, but {} {} wrong", d.wrong->wrong.size(),
                                    d.wrong->wrong.size() == 1 ? "value is" : "values are");
    case Verdict::unexplained:
      return d.user_models.found() ? "A user-defined model explains the records"
                                   : "No listed effect explains the records";
    case Verdict::interrupted:
      return "Interrupted before a verdict";
    default:
      break;
  }
  const auto named = std::ranges::find_if(d.probabilities, [](const auto& e) { return e.place >= 0; });
  if (named == d.probabilities.end())
    return (d.effects.empty() ? "A component" : d.effects.front()) + " is missing";
  if (named->probability <= thresholds::posterior.named)
    return fmt::format("Undecided: one of {} effects is missing", d.equivalent.size() + 1);
  const bool replaces = d.ranked[static_cast<std::size_t>(named->place)].hypothesis.replaces;
  return fmt::format("{} {} ({})", named->name, replaces ? "explains the records" : "is missing",
                     report::probability_text(named->probability));
}
bool as_submitted(const Diagnosis& d) { return d.verdict == Verdict::adequate && !d.wrong; }
report::Tone tone(const Diagnosis& d) {
  return as_submitted(d)                     ? report::Tone::good
         : d.verdict == Verdict::unexplained ? report::Tone::bad
                                             : report::Tone::found;
}
class DiagnosisPage {
 public:
  DiagnosisPage(const plant::PlantModel& model, const Diagnosis& d, const report::Provenance& rows,
                const std::vector<compare::Played>& played)
      : model_(model),
        d_(d),
        rows_(rows),
        played_(played),
        figures_(report_figures(d)),
        page_{"Diagnosis: " + model.name,
              fmt::format("{} of {:g} MVA · {} {} · recorded terminal voltage played into the model",
                          plant::subject(model), model.plant.mva, d.events.size(),
                          d.events.size() == 1 ? "event" : "events")} {}

  std::string html() {
    opening();
    sides();
    probabilities();
    hypotheses();
    few_wrong();
    user_models_on_page(d_, page_);
    error_maps();
    limits();
    parameters();
    at_a_glance();
    compare::panels_part(page_, played_);
    for (std::size_t e = 0; e < figures_.events.size(); ++e) event(e);
    method();
    compare::glossary_part(page_);
    page_.provenance(rows_);
    page_.add(report::Data{"figures", json_text(diagnosis_json(model_, d_, rows_))});
    return report::html(page_);
  }

 private:
  [[nodiscard]] bool with_after() const { return figures_.after != nullptr; }

  /// Adds the verdict, and the worst event with the submitted model and with the added effect. Without an
  /// added effect, the refitted model is shown instead.
  void opening() {
    compare::FirstScreen screen{headline(d_), {d_.sentence}, tone(d_)};
    if (!played_.empty()) screen.before = &played_.front();
    if (played_.size() > 1) screen.after = &played_[1];
    screen.judge_before = !as_submitted(d_);
    screen.next = next_command(d_, rows_);
    compare::first_screen(page_, screen);
  }
  /// Adds both verdicts, and the errors of the refitted model with their limits.
  void limits() {
    if (played_.empty()) return;
    page_.section("Verdicts");
    const compare::Fitness& fitness = played_.back().fitness;
    page_.add(report::Verdict{(played_.size() > 1 ? "Refitted model. " : "") + fitness.sentence,
                              !fitness.not_judged.empty() ? report::Tone::found
                              : fitness.fit               ? report::Tone::good
                                                          : report::Tone::bad});
    page_.text(fmt::format("Statistically complete: {}.", d_.verdict == Verdict::adequate ? "yes" : "no"));
    compare::limits_part(page_, played_);
  }

  void probabilities() {
    if (d_.probabilities.empty()) return;
    page_.section("Candidates");
    const std::size_t set = hypothesis::credible(d_.probabilities);
    report::Bars bars{"Probability [%]", "%", 0, "", {}};
    for (std::size_t i = 0; i < d_.probabilities.size() && (i < set || i < kLeastProbable); ++i)
      bars.bars.push_back({d_.probabilities[i].name, 100 * d_.probabilities[i].probability,
                           i < set ? "good" : "poor",
                           report::probability_text(d_.probabilities[i].probability)});
    page_.text(fmt::format(
        "Probability of each explanation, including that none of the tried effects is right. The "
        "blue bars form the {:.0f} % credible set. {} Measured reliability of these probabilities: "
        "docs/reference/blind-test-results.md. {}",
        100 * thresholds::posterior.set, tempering_note(), false_positive_note()));
    page_.add(report::Begin{report::Begin::Layout::row});
    page_.add(bars);
    next_measurements();
    page_.add(report::End{});
  }
  /// Adds the table of measurements that would separate the candidates. Equal values share a row.
  void next_measurements() {
    if (d_.would_decide.next.empty()) return;
    report::Table table{
        fmt::format(
            "Possible next measurements, with the expected number of remaining candidates (now {:.0f}), from "
            "simulations of the record with each candidate.",
            d_.would_decide.now),
        {"record", "remaining candidates"},
        {}};
    for (const auto& n : d_.would_decide.next) {
      const std::string left = fmt::format("{:.1f}", n.expected);
      if (!table.rows.empty() && table.rows.back().back().text == left)
        table.rows.back().front().text += "; or " + n.what;
      else
        table.rows.push_back({n.what, left});
    }
    page_.add(table);
  }

  void at_a_glance() {
    page_.section("Error of each event");
    report::Table table{
        "Normalised RMS of each event: all channels, whitened by the measured noise (square root of chi2 per value). "
        "Noise alone gives 1 ×.",
        {"event", "refitted"},
        {}};
    if (with_after()) table.header.push_back("with " + figures_.after_name);
    const bool unseen = std::ranges::any_of(
        figures_.events, [](const ReportEvent& e) { return std::isfinite(e.unseen_after); });
    if (unseen) {
      table.header.emplace_back("held out: refitted");
      table.header.push_back("held out: with " + figures_.after_name);
    }
    for (const auto& e : figures_.events) {
      std::vector<report::Cell> row = {e.event->record.name, report::times_noise(e.before)};
      if (with_after()) row.emplace_back(report::times_noise(e.after));
      if (unseen) {
        row.emplace_back(report::times_noise(e.unseen_before));
        row.emplace_back(report::times_noise(e.unseen_after));
      }
      table.rows.push_back(std::move(row));
    }
    page_.add(table);
    tolerance();
  }
  /// Adds the share of each channel's samples within the stated tolerance.
  void tolerance() {
    report::Table table{
        "Share of samples within the tolerance, the 99 % noise band of each channel (noise alone: 99 %).",
        {"event", "channel", "tolerance", "refitted"},
        {}};
    if (with_after()) table.header.push_back("with " + figures_.after_name);
    for (const auto& e : figures_.events)
      for (const auto& c : e.channels) {
        std::vector<report::Cell> row = {
            e.event->record.name, c.name,
            fmt::format("± {:.3g} {}", constants::normal99 * c.noise * c.scale, c.unit),
            percent(c.inside_before)};
        if (with_after()) row.emplace_back(percent(c.inside_after));
        table.rows.push_back(std::move(row));
      }
    page_.add(table);
  }

  [[nodiscard]] std::vector<compare::LabelledMap> maps(compare::ErrorMap ReportChannel::*which) const {
    std::vector<compare::LabelledMap> all;
    for (const auto& e : figures_.events)
      for (const auto& c : e.channels)
        all.push_back({e.event->record.name, c.name, c.unit, c.scale, &e.windows, &(c.*which), c.size});
    return all;
  }
  void error_maps() {
    page_.section("Error map");
    page_.text("Refitted model.");
    compare::heat_maps(page_, compare::worst_map_table(maps(&ReportChannel::map_before)));
    if (!with_after()) return;
    report::Table after = compare::worst_map_table(maps(&ReportChannel::map_after));
    after.caption = "Model with " + figures_.after_name + ".";
    compare::heat_maps(page_, after);
  }

  void sides() {
    if (d_.torque.fit.events.empty() && d_.field.fit.events.empty()) return;
    page_.section("Excitation or mechanical side");
    page_.text(
        "An additional mechanical torque, then an additional field voltage, were estimated as arbitrary functions "
        "of time (unknown-input estimation) so that the response fits the records. The input with the "
        "smaller residual indicates the side of the missing component.");
    report::Bars bars{"Normalised RMS", "×", 1.0, "noise alone", {}};
    const auto add = [&](const std::string& name, double reduced_chi2) {
      const double left = std::sqrt(reduced_chi2);
      bars.bars.push_back({name, left, left < 1.5 ? "good" : "poor"});
    };
    add("refitted", d_.base.reduced_chi2());
    if (!d_.torque.fit.events.empty()) add("with an inferred torque", d_.torque.reduced_chi2());
    if (!d_.field.fit.events.empty()) add("with an inferred field voltage", d_.field.reduced_chi2());
    page_.add(report::Begin{report::Begin::Layout::panels});
    page_.add(bars);
    const std::size_t worst =
        !played_.empty() && !played_.front().events.empty() ? compare::worst_event(played_.front()).first : 0;
    better_input(d_) == &d_.field ? input(worst, d_.field, kField) : input(worst, d_.torque, kTorque);
    page_.add(report::End{});
    if (d_.side != hypothesis::Side::none)
      page_.text(fmt::format("Side: {}.", hypothesis::side_name(d_.side)));
  }

  void hypotheses() {
    if (d_.ranked.empty()) return;
    page_.section("Hypotheses");
    page_.text(fmt::format(
        "{} hypotheses (added or replaced effects, freed parameters, other conventions) were "
        "tried, each alone or as a pair of effects. The most probable ones were fitted together "
        "with the model's parameters; the others were ranked by a preliminary estimate (marked “not "
        "fitted”). Evidence is 2 ln(Bayes factor) of the effect "
        "(Laplace's approximation): acceptance requires {:.0f} or more; below 0 the added "
        "parameters do not improve the model. The leading hypotheses were then judged on held-out events.",
        d_.ranked.size(), thresholds::evidence.accepted.value));
    const double most = std::max(1.0, d_.ranked.front().gain);
    report::Bars bars{
        "Evidence (logarithmic)", "", std::log10(thresholds::evidence.accepted.value), "accepted", {}};
    for (std::size_t i = 0; i < std::min(kHypothesesShown, d_.ranked.size()); ++i)
      bars.bars.push_back(
          {hypothesis::full_name(d_.ranked[i].hypothesis), std::log10(std::max(1.0, d_.ranked[i].gain)),
           d_.ranked[i].accepted || (d_.ranked[i].gain >= most && most > 10) ? "good" : "poor",
           fmt::format("{:.0f}", d_.ranked[i].gain)});
    page_.add(bars);
    page_.add(report::Begin{report::Begin::Layout::fold, fmt::format("All {} hypotheses", d_.ranked.size())});
    report::Table table{
        "",
        {"hypothesis", "description", "side", "evidence", "normalised RMS", "held-out events", "judgement"},
        {}};
    for (const auto& h : d_.ranked) {
      double worst = 0;
      for (const auto& u : h.held_out) worst = std::max(worst, std::sqrt(u.after));
      table.rows.push_back(
          {hypothesis::full_name(h.hypothesis), h.hypothesis.what,
           std::string(hypothesis::side_name(h.hypothesis.side)), fmt::format("{:.1f}", h.gain),
           h.fitted && h.fit.values > 0 ? report::times_noise(std::sqrt(h.fit.reduced_chi2())) : "",
           h.held_out.empty() ? "–" : "≤ " + report::times_noise(worst),
           h.accepted ? "accepted" : h.why_not});
    }
    page_.add(table);
    page_.add(report::End{});
  }

  /// Adds the section on wrong parameters, if a small set of them explains the records.
  void few_wrong() {
    if (!d_.wrong) return;
    page_.section("Wrong parameters");
    page_.text(calibrate::wrong_sentence(*d_.wrong, thresholds::adequacy.reduced_chi2));
    report::Table table{
        "Every other parameter keeps its value. Evidence: increase of the cost (chi2) if this "
        "parameter also keeps its value and the others are refitted. Share of error: this "
        "increase, relative to the increase if all parameters keep their values.",
        {"parameter", "unit", "submitted", "fitted", "95 % interval", "evidence", "share of error",
         "alternative"},
        {}};
    for (const auto& w : d_.wrong->wrong) {
      table.rows.push_back({w.fit.full_name(), w.fit.unit, value_text(w.fit.start), value_text(w.fit.value),
                            fmt::format("{} … {}", value_text(w.fit.low), value_text(w.fit.high)),
                            fmt::format("{:.0f}", w.evidence), fmt::format("{:.0f} %", 100 * w.share),
                            w.tied.empty() ? "–" : fmt::format("{}", fmt::join(w.tied, ", "))});
    }
    page_.add(table);
  }

  void parameters() {
    if (!with_after() && !d_.ruling.adequate) return;  // values of a rejected model are not shown
    const fit::Fit& last = with_after() ? *figures_.after : d_.base;
    if (last.parameters.empty()) return;  // the addition is an inferred input
    page_.section("Parameters");
    report::Table table{
        "Fitted values with 95 % intervals. Last column: reduction of the parameter's variance by the records, "
        "1 − posterior variance / prior variance.",
        {"parameter", "unit", "submitted", "refitted"},
        {}};
    if (with_after()) table.header.push_back("with " + figures_.after_name);
    table.header.insert(table.header.end(), {"95 % interval", "variance reduction"});
    for (const auto& p : last.parameters) {
      const auto base = std::ranges::find_if(d_.base.parameters, [&](const fit::FittedParameter& b) {
        return b.block == p.block && b.name == p.name;
      });
      const bool known = base != d_.base.parameters.end();
      const auto symbol = sim::plant::parameter_record(last.plant, p.where.id).symbol;
      std::vector<report::Cell> row = {p.block + " " + std::string(symbol), p.unit,
                                       known ? value_text(base->start) : "–",
                                       known ? value_text(base->value) : "–"};
      if (with_after()) row.emplace_back(value_text(p.value));
      row.emplace_back(std::isfinite(p.error)
                           ? fmt::format("{} … {}{}", value_text(p.low), value_text(p.high),
                                         p.at_bound ? " (at its bound: interval not valid)" : "")
                           : "–");
      row.emplace_back(std::isfinite(p.decided) ? fmt::format("{:.0f} %", 100 * p.decided) : "–");
      table.rows.push_back(std::move(row));
    }
    page_.add(table);
  }

  /// Adds the inferred inputs and the error map of one event, collapsed.
  void event(std::size_t index) {
    const ReportEvent& e = figures_.events[index];
    const record::Record& r = e.event->record;
    page_.add(report::Begin{report::Begin::Layout::fold, "Inferred inputs and error map of " + r.name});
    page_.add(report::Begin{report::Begin::Layout::panels});
    input(index, d_.torque, kTorque);
    input(index, d_.field, kField);
    page_.add(report::End{});
    if (figures_.events.size() > 1) {
      std::vector<compare::LabelledMap> own;
      for (const auto& c : e.channels)
        own.push_back({r.name, c.name, c.unit, c.scale, &e.windows,
                       with_after() ? &c.map_after : &c.map_before, c.size});
      report::Table table = compare::map_table(own);
      table.caption =
          fmt::format("Error map of {}{}.", r.name, with_after() ? ", with " + figures_.after_name : "");
      page_.add(table);
    }
    page_.add(report::End{});
  }
  void input(std::size_t index, const reduced::FreeInput& m, const std::string& title) {
    if (index >= m.fit.events.size() || m.of(index).t.empty()) return;
    const event::FitEvent& of = *figures_.events[index].event;
    const auto& value = m.of(index).value;
    report::Curves curves{of.record.name + ": " + title, "pu", of.record.name, m.of(index).t};
    if (!of.switchings.empty()) curves.fault = {of.switchings.front().time, of.switchings.back().time};
    curves.series.push_back({"inferred", report::Ink::inferred, value});
    std::vector<double> low, high;
    for (std::size_t k = 0; k < value.size(); ++k) {
      const double half = constants::normal95 * m.deviation[index][static_cast<Eigen::Index>(k)];
      low.push_back(value[k] - half);
      high.push_back(value[k] + half);
    }
    curves.series.push_back({"lower 95 % limit", report::Ink::limit, low});
    curves.series.push_back({"upper 95 % limit", report::Ink::limit, high});
    page_.add(std::move(curves));
  }

  void method() {
    page_.add(report::Begin{report::Begin::Layout::fold, "Method"});
    page_.text(
        "Playback of the recorded terminal voltage and angle into the model, with the response "
        "compared with the measurement for each event, as in model verification reports under NERC "
        "MOD-026-2 (formerly MOD-026-1 and MOD-027-1) and MOD-033 (systems). These standards set no numerical "
        "tolerance. Fitness for purpose uses the limits of “Verdicts”, and the error map the joint 99.9 % "
        "noise limit. "
        "The table of tolerances uses the 99 % band of the noise, estimated before each event.");
    page_.text(
        "“Refitted” means the submitted structure with its parameters fitted to all events; an "
        "error that remains is not caused by the parameters. A bin of the error map is the RMS "
        "of the residual in a time window and a frequency band, divided by that of noise alone. "
        "With 99.9 % probability, noise alone stays below the bounds of all bins.");
    page_.text(fmt::format("Computed in {:.0f} s.", d_.seconds));
    page_.add(report::End{});
  }

  const plant::PlantModel& model_;
  const Diagnosis& d_;
  const report::Provenance& rows_;
  const std::vector<compare::Played>& played_;
  ReportFigures figures_;
  report::Document page_;
};

}  // namespace

std::string next_command(const Diagnosis& d, const report::Provenance& rows) {
  if (d.verdict == Verdict::adequate) return compare::next_command(rows, "calibrate");
  if (d.effects.empty()) return {};
  std::string command = "add";
  for (const std::string& effect : d.effects) command += " " + shell_word(effect);
  return compare::next_command(rows, command);
}

std::string diagnosis_html(const plant::PlantModel& model, const Diagnosis& diagnosis,
                           const report::Provenance& provenance, const std::vector<compare::Played>& played) {
  return DiagnosisPage(model, diagnosis, provenance, played).html();
}

}  // namespace swingbank::validate::diagnose
