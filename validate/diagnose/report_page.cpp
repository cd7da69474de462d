// The page of a diagnosis: verdict, figures, evidence, events, provenance.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/json.hpp"
#include "sim/plant/parameter_id.hpp"
#include "validate/compare/error_map_table.hpp"
#include "validate/compare/page_parts.hpp"
#include "validate/diagnose/detail/false_positives.hpp"
#include "validate/diagnose/detail/report_user_models.hpp"
#include "validate/diagnose/detail/verdict.hpp"
#include "validate/diagnose/report.hpp"

namespace swingbank::validate::diagnose {
namespace {

constexpr std::size_t kBars = 12;          // maximum number of plotted hypotheses; the table holds all
constexpr std::size_t kLeastProbable = 4;  // number of plotted explanations if the set is smaller

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }
std::string value_text(double v) { return std::isfinite(v) ? fmt::format("{:.4g}", v) : "–"; }

std::vector<std::pair<double, double>> fault_bands(const event::FitEvent& e) {
  if (e.switchings.empty()) return {};
  return {{e.switchings.front().time, e.switchings.back().time}};
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
        page_("Diagnosis: " + model.name,
              fmt::format("{} of {:g} MVA · {} {} · recorded terminal voltage played into the model",
                          plant::subject(model), model.plant.mva, d.events.size(),
                          d.events.size() == 1 ? "event" : "events")) {}

  std::string html() {
    compare::verdict_part(page_, played_, d_.verdict == Verdict::adequate, d_.sentence,
                          d_.verdict == Verdict::adequate      ? report::Tone::good
                          : d_.verdict == Verdict::unexplained ? report::Tone::bad
                                                               : report::Tone::found);
    page_.text(false_positive_note());
    probabilities();
    compare::panels_part(page_, played_);
    few_wrong();
    parameters();
    at_a_glance();
    error_maps();
    sides();
    hypotheses();
    user_models_on_page(d_, page_);
    page_.section("Event results");
    for (std::size_t e = 0; e < figures_.events.size(); ++e) event(e);
    method();
    compare::glossary_part(page_);
    page_.provenance(rows_);
    page_.data("figures", json_text(diagnosis_json(model_, d_, rows_)));
    return page_.html();
  }

 private:
  [[nodiscard]] bool with_after() const { return figures_.after != nullptr; }

  void probabilities() {
    if (d_.probabilities.empty()) return;
    const std::size_t set = hypothesis::credible(d_.probabilities);
    report::Bars bars{"Probability [%]", "%", 0, "", {}};
    for (std::size_t i = 0; i < d_.probabilities.size() && (i < set || i < kLeastProbable); ++i)
      bars.bars.push_back({d_.probabilities[i].name, 100 * d_.probabilities[i].probability, i < set,
                           hypothesis::probability_text(d_.probabilities[i].probability)});
    page_.bars(bars);
    page_.text(
        fmt::format("Probability of each explanation, including that none of the tried effects is right. The "
                    "blue bars form the {:.0f} % credible set. Measured reliability of these probabilities: "
                    "docs/reference/blind-test-results.md.",
                    100 * thresholds::posterior.set));
    if (d_.would_decide.next.empty()) return;
    report::Table table{
        fmt::format("Next measurement: expected number of the {:.0f} candidates that remain, from "
                    "simulations of the record with each candidate.",
                    d_.would_decide.now),
        {"record", "remaining candidates"},
        {}};
    for (const auto& n : d_.would_decide.next)
      table.rows.push_back({n.what, fmt::format("{:.1f}", n.expected)});
    page_.table(table);
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
      std::vector<report::Cell> row = {e.event->record.name, compare::times_noise(e.before)};
      if (with_after()) row.emplace_back(compare::times_noise(e.after));
      if (unseen) {
        row.emplace_back(compare::times_noise(e.unseen_before));
        row.emplace_back(compare::times_noise(e.unseen_after));
      }
      table.rows.push_back(std::move(row));
    }
    page_.table(table);
    tolerance();
  }
  /// Adds the share of each channel's samples within the stated tolerance.
  void tolerance() {
    report::Table table{
        "Share of samples within the stated tolerance, the 99 % band of each channel's noise; noise alone "
        "gives 99 %.",
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
    page_.table(table);
  }

  [[nodiscard]] std::vector<compare::LabelledMap> maps(compare::ErrorMap ReportChannel::*which) const {
    std::vector<compare::LabelledMap> all;
    for (const auto& e : figures_.events)
      for (const auto& c : e.channels)
        all.push_back({e.event->record.name, c.name, c.unit, c.scale, &e.windows, &(c.*which)});
    return all;
  }
  void error_maps() {
    page_.section("Error map");
    report::Table before = compare::worst_map_table(maps(&ReportChannel::map_before));
    before.caption = "Model with refitted parameters. " + before.caption;
    page_.table(before);
    if (!with_after()) return;
    report::Table after = compare::worst_map_table(maps(&ReportChannel::map_after));
    after.caption = "With " + figures_.after_name + ". Same units.";
    page_.table(after);
  }

  void sides() {
    if (d_.torque.fit.events.empty() && d_.field.fit.events.empty()) return;
    page_.section("Excitation or mechanical side");
    page_.text(
        "Before the search for effects, a mechanical torque and then a field voltage, free in "
        "time, were inferred such that the response matches the records. The input with the "
        "smaller residual indicates the side of the missing component.");
    report::Bars bars{"Normalised RMS", "×", 1.0, "noise alone", {}};
    const auto add = [&](const std::string& name, double reduced_chi2) {
      const double left = std::sqrt(reduced_chi2);
      bars.bars.push_back({name, left, left < 1.5});
    };
    add("refitted", d_.base.reduced_chi2());
    if (!d_.torque.fit.events.empty()) add("with an inferred torque", d_.torque.reduced_chi2());
    if (!d_.field.fit.events.empty()) add("with an inferred field voltage", d_.field.reduced_chi2());
    page_.bars(bars);
    if (d_.side != hypothesis::Side::none)
      page_.text(fmt::format("Side: {}.", hypothesis::side_name(d_.side)));
  }

  void hypotheses() {
    if (d_.ranked.empty()) return;
    page_.section("Hypotheses");
    page_.text(
        fmt::format("{} effects were added one at a time. Each was fitted together with the model's "
                    "parameters until its rank was clear. Evidence is 2 ln(Bayes factor) of the effect "
                    "(Laplace's approximation): {:.0f} or more is accepted; below 0 the added parameters do "
                    "not improve the model. The leading effects were then judged on held-out events.",
                    d_.ranked.size(), thresholds::evidence.accepted.value));
    const double most = std::max(1.0, d_.ranked.front().gain);
    report::Bars bars{
        "Evidence (logarithmic)", "", std::log10(thresholds::evidence.accepted.value), "accepted", {}};
    for (std::size_t i = 0; i < std::min(kBars, d_.ranked.size()); ++i)
      bars.bars.push_back({hypothesis::full_name(d_.ranked[i].hypothesis),
                           std::log10(std::max(1.0, d_.ranked[i].gain)),
                           d_.ranked[i].accepted || (d_.ranked[i].gain >= most && most > 10),
                           fmt::format("{:.0f}", d_.ranked[i].gain)});
    page_.bars(bars);
    report::Table table{
        "",
        {"hypothesis", "description", "side", "evidence", "normalised RMS", "held-out events", "judgement"},
        {}};
    for (const auto& h : d_.ranked) {
      double worst = 0;
      for (const auto& u : h.held_out) worst = std::max(worst, std::sqrt(u.after));
      table.rows.push_back({hypothesis::full_name(h.hypothesis), h.hypothesis.what,
                            std::string(hypothesis::side_name(h.hypothesis.side)),
                            fmt::format("{:.1f}", h.gain),
                            h.fit.values > 0 ? compare::times_noise(std::sqrt(h.fit.reduced_chi2())) : "–",
                            h.held_out.empty() ? "–" : "≤ " + compare::times_noise(worst),
                            h.accepted ? "accepted" : h.why_not});
    }
    page_.table(table);
  }

  /// Adds the section on wrong parameters, if a small set of them explains the records.
  void few_wrong() {
    if (!d_.wrong) return;
    page_.section("Wrong parameters");
    page_.text(calibrate::wrong_sentence(*d_.wrong, thresholds::adequacy.reduced_chi2));
    report::Table table{
        "Every other parameter keeps its value. Evidence: increase of the cost (chi2) if this "
        "parameter also keeps its value and the others are refitted. Share of error: this "
        "increase as a share of the cost above that of the full fit.",
        {"parameter", "unit", "submitted", "fitted", "95 % interval", "evidence", "share of error",
         "alternative"},
        {}};
    for (const auto& w : d_.wrong->wrong) {
      std::string tied;
      for (const auto& t : w.tied) tied += (tied.empty() ? "" : ", ") + t;
      table.rows.push_back({w.fit.full_name(), w.fit.unit, value_text(w.fit.start), value_text(w.fit.value),
                            fmt::format("{} … {}", value_text(w.fit.low), value_text(w.fit.high)),
                            fmt::format("{:.0f}", w.evidence), fmt::format("{:.0f} %", 100 * w.share),
                            tied.empty() ? "–" : tied});
    }
    page_.table(table);
  }

  void parameters() {
    if (!with_after() && !d_.ruling.adequate) return;  // values of a rejected model are not shown
    const fit::Fit& last = with_after() ? *figures_.after : d_.base;
    if (last.parameters.empty()) return;  // the addition is an inferred input
    page_.section("Parameters");
    report::Table table{
        "Fitted values with 95 % intervals. Last column: share of the interval that the records "
        "determine; the prior determines the rest.",
        {"parameter", "unit", "submitted", "refitted"},
        {}};
    if (with_after()) table.header.push_back("with " + figures_.after_name);
    table.header.insert(table.header.end(), {"95 % interval", "determined by records"});
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
    page_.table(table);
  }

  void event(std::size_t index) {
    const ReportEvent& e = figures_.events[index];
    const record::Record& r = e.event->record;
    page_.subsection(r.name);
    std::string switching_times;
    for (const auto& s : e.event->switchings)
      switching_times += fmt::format("{}{:.3f} s", switching_times.empty() ? "" : ", ", s.time);
    page_.text(fmt::format(
        "{} samples at {:.6g} per second. Switching: {}. Start: P = {:.2f} MW, Q = {:.2f} Mvar, V = "
        "{:.4f} pu.",
        r.samples(), r.rate(), switching_times.empty() ? "none" : switching_times,
        e.event->start.P * r.base.mva, e.event->start.Q * r.base.mva, std::abs(e.event->start.voltage)));
    input(index, d_.torque, "Inferred missing torque", "added to Tm [pu]");
    input(index, d_.field, "Inferred missing field voltage", "added to Efd [pu]");
    if (figures_.events.size() < 2) return;
    std::vector<compare::LabelledMap> own;
    for (const auto& c : e.channels)
      own.push_back(
          {r.name, c.name, c.unit, c.scale, &e.windows, with_after() ? &c.map_after : &c.map_before});
    report::Table table = compare::map_table(own);
    table.caption =
        fmt::format("Error map of {}{}.", r.name, with_after() ? ", with " + figures_.after_name : "");
    page_.table(table);
  }
  void input(std::size_t index, const reduced::FreeInput& m, const std::string& title,
             const std::string& label) {
    if (index >= m.fit.events.size() || m.of(index).t.empty()) return;
    const std::string& name = figures_.events[index].event->record.name;
    report::Curves curves{
        title, "t [s]", label, name, m.of(index).t, {}, fault_bands(*figures_.events[index].event)};
    const auto& value = m.of(index).value;
    curves.series.push_back({title, "#7d3c98", false, value});
    std::vector<double> low, high;
    for (std::size_t k = 0; k < value.size(); ++k) {
      const double half = constants::normal95 * m.deviation[index][static_cast<Eigen::Index>(k)];
      low.push_back(value[k] - half);
      high.push_back(value[k] + half);
    }
    curves.series.push_back({"lower 95 % limit", "#c9a6da", false, low});
    curves.series.push_back({"upper 95 % limit", "#c9a6da", false, high});
    page_.curves(curves);
  }

  void method() {
    page_.section("Method");
    page_.text(
        "Playback of the recorded terminal voltage and angle into the model, with the response "
        "compared with the measurement for each event, as in verification reports under NERC "
        "MOD-026 and MOD-027 (plants) and MOD-033 (systems). These standards set no numerical "
        "tolerance; this page uses the 99 % band of the noise, estimated before each event.");
    page_.text(
        "“Refitted” means the submitted structure with its parameters fitted to all events; an "
        "error that remains is not caused by the parameters. A bin of the error map is the RMS "
        "of the residual in a time window and a frequency band, divided by that of noise alone. "
        "With 99.9 % probability, noise alone stays below the bounds of all bins.");
    page_.text(fmt::format("Computed in {:.0f} s.", d_.seconds));
  }

  const plant::PlantModel& model_;
  const Diagnosis& d_;
  const report::Provenance& rows_;
  const std::vector<compare::Played>& played_;
  ReportFigures figures_;
  report::Page page_;
};

}  // namespace

std::string diagnosis_html(const plant::PlantModel& model, const Diagnosis& diagnosis,
                           const report::Provenance& provenance, const std::vector<compare::Played>& played) {
  return DiagnosisPage(model, diagnosis, provenance, played).html();
}

}  // namespace swingbank::validate::diagnose
