#include "validate/compare/page_parts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <ranges>

#include "validate/compare/error_map_table.hpp"
#include "validate/compare/error_table.hpp"
#include "validate/compare/event_title.hpp"
#include "validate/compare/first_screen.hpp"

namespace swingbank::validate::compare {
namespace {

using report::Ink;

std::string number_text(double v) { return std::isfinite(v) ? fmt::format("{:.4g}", v) : "–"; }

/// Models with a playback of the event, and their line styles; the first model provides the measured curves.
using Models = std::vector<std::pair<const Played*, Ink>>;
Models models_of(const std::vector<Played>& played, std::size_t event) {
  Models models;
  for (std::size_t k = 0; k < played.size(); ++k)
    if (event < played[k].events.size())
      models.emplace_back(&played[k], played.size() == 1 || k == 1 ? Ink::fitted
                                      : k == 0                     ? Ink::submitted
                                                                   : Ink::refitted);
  return models;
}

/// Chart of one channel: measured, and simulated by each model.
void channel_panel(report::Document& page, const Models& models, std::size_t event, const std::string& name) {
  report::Curves c = channel_curves(models, event, name);
  if (!c.series.empty()) page.add(std::move(c));
}

/// Chart of a recorded quantity that is played in.
void input_panel(report::Document& page, const EventComparison& e, const std::string& name,
                 const std::string& unit, std::vector<double> values) {
  if (values.size() != e.record.t.size()) return;  // not recorded
  report::Curves c = event_chart(e, name + ", played in", unit);
  c.series.push_back({"measured", Ink::measured, std::move(values)});
  page.add(c);
}

void voltage_panels(report::Document& page, const Models& models, std::size_t event) {
  const EventComparison& e = models.front().first->events[event];
  if (find_channel(models.front().first, event, "V"))
    channel_panel(page, models, event, "V");
  else
    input_panel(page, e, "V", "pu", e.record.V);
  const double nominal = e.record.base.frequency;
  if (!e.record.f.empty())
    input_panel(page, e, "f", "Hz", scaled(e.record.f, nominal, nominal));
  else if (e.record.angle != record::AngleSource::none && e.record.theta.size() == e.record.t.size())
    input_panel(page, e, "f from the angle", "Hz",
                scaled(frequency_of(e.record.t, e.record.theta, nominal), nominal, nominal));
  else
    page.note("f: neither frequency nor angle was recorded.");
}

void power_panels(report::Document& page, const Models& models, std::size_t event) {
  const EventComparison& e = models.front().first->events[event];
  for (const char* name : {"P", "Q"}) {
    const auto& recorded = name[0] == 'P' ? e.record.P : e.record.Q;
    if (find_channel(models.front().first, event, name))
      channel_panel(page, models, event, name);
    else if (!recorded.empty())
      input_panel(page, e, name, name[0] == 'P' ? "MW" : "Mvar", scaled(recorded, e.record.base.mva));
  }
}

/// Charts of the residuals of P and Q.
void residual_panels(report::Document& page, const Models& models, std::size_t event) {
  for (const char* name : {"P", "Q"}) {
    const EventComparison& e = models.front().first->events[event];
    const ChannelComparison* first = find_channel(models.front().first, event, name);
    if (!first) continue;
    report::Curves c = event_chart(e, fmt::format("{}, modelled − measured", name), first->unit);
    for (const auto& [model, ink] : models)
      if (const ChannelComparison* m = find_channel(model, event, name))
        c.series.push_back({model->name, ink, scaled(m->residual, m->scale)});
    page.add(std::move(c));
  }
}

std::string switching_times_text(const EventComparison& e) {
  std::string text;
  for (const auto& s : e.switchings) text += fmt::format("{}{:.4f} s", text.empty() ? "" : ", ", s.time);
  return text.empty() ? "none"
                      : text + (!e.detected ? " (given)"
                                : e.fitted  ? " (estimated and fitted)"
                                            : " (estimated)");
}

void event_panels(report::Document& page, const std::vector<Played>& played, std::size_t event, bool large) {
  const Models models = models_of(played, event);
  if (models.empty()) return;
  const EventComparison& e =
      models.back().first->events[event];  // title and notes are those of the last model
  page.add(report::Begin{report::Begin::Layout::fold,
                         fmt::format("Event {}: {}, {}", event + 1, e.record.name, event_title(e))});
  const auto begins = record::beginning(e.record);
  page.text(fmt::format(
      "{}{} samples at {:.6g} per second. Switching: {}. Operating point: P = {:.2f} MW, Q = {:.2f} Mvar, "
      "V = {:.4f} pu.",
      begins.empty() ? "" : "t = 0 is " + begins + ". ", e.record.samples(), e.record.rate(),
      switching_times_text(e), e.playback.start.P * e.record.base.mva, e.playback.start.Q * e.record.base.mva,
      std::abs(e.playback.start.voltage)));
  for (const auto& note : e.notes) page.note(note);
  page.add(report::Begin{report::Begin::Layout::panels});
  voltage_panels(page, models, event);
  if (!large) power_panels(page, models, event);
  for (const auto& c : e.channels)
    if (c.name != "V" && c.name != "frequency" && c.name != "P" && c.name != "Q")
      channel_panel(page, models, event, c.name);
  residual_panels(page, models, event);
  page.add(report::End{});
  page.add(report::End{});
}

/// Returns "Submitted model", "Model with SEXS".
std::string model_title(const std::string& name) {
  if (name.starts_with("with ")) return "Model " + name;
  std::string title = name + " model";
  title.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(title.front())));
  return title;
}

std::vector<std::string> records_of(const std::vector<Played>& played) {
  std::vector<std::string> names;
  for (const EventComparison& e : followed_events(played)) names.push_back(e.record.name);
  return names;
}

/// Returns why the verdict of a fit and the error map of the playback differ; empty if they agree.
std::string difference_text(const CommandPage& p) {
  const std::vector<std::string> beyond = beyond_noise(p.played.back());
  if (!p.complete || beyond.empty()) return {};
  constexpr std::size_t kListedChannels = 3;
  std::string channels = fmt::format("{}", fmt::join(beyond | std::views::take(kListedChannels), ", "));
  if (beyond.size() > kListedChannels)
    channels += fmt::format(" and {} others", beyond.size() - kListedChannels);
  return fmt::format(
      "Statistically complete by the reduced chi-square, which averages over each event and, in held-out events, "
      "allows for the uncertainty of the parameters. The error map tests each window and band without that "
      "allowance: {} above the noise bound.",
      channels + (beyond.size() == 1 ? " is" : " are"));
}

/// Returns the first screen of a command whose last model is the result.
FirstScreen screen_of(const CommandPage& p) {
  FirstScreen s;
  const Fitness& fitness = p.played.back().fitness;
  const bool several = p.played.size() > 1;
  s.headline = headline_of(p);
  s.reasons = {fitness.not_judged.empty()
                   ? (several ? model_title(p.played.back().name) + ". " : "") + fitness.sentence
                   : complete_text(p.complete, p.sentence)};
  if (std::string use = p.use.sentence(records_of(p.played)); !use.empty())
    s.reasons.push_back(std::move(use));
  const std::string difference = difference_text(p);
  if (!difference.empty()) s.reasons.push_back(difference);
  const bool fit = fitness.not_judged.empty() ? fitness.fit : p.complete;
  s.tone = p.complete && fit   ? difference.empty() ? report::Tone::good : report::Tone::warn
           : fit || p.complete ? report::Tone::warn
                               : report::Tone::bad;
  s.before = &p.played.front();
  if (several) s.after = &p.played.back();
  s.use = p.use;
  s.next = p.next;
  return s;
}

}  // namespace

void limits_part(report::Document& page, const std::vector<Played>& played) {
  if (played.empty()) return;
  const Fitness& counts = played.back().fitness;
  for (std::size_t k = 0; k + 1 < played.size(); ++k)
    page.text(model_title(played[k].name) + ". " + played[k].fitness.sentence);
  if (counts.not_judged.empty()) page.add(worst_fitness_table(counts));
  if (!counts.movements.empty()) page.add(movement_table(counts));
}

void panels_part(report::Document& page, const std::vector<Played>& played) {
  std::size_t events = 0;
  for (const Played& p : played) events = std::max(events, p.events.size());
  if (events == 0) return;
  page.section("Events");
  page.add(report::Paragraph{
      "Drag across a chart to zoom in on a time range (all charts of an event follow); double-click to see the whole "
      "record. The grey band is the fault.",
      report::Paragraph::Kind::hint});
  const auto first = std::ranges::find_if(played, [](const Played& p) { return !p.events.empty(); });
  const auto [worst, shown] = worst_event(*first);
  for (std::size_t e = 0; e < events; ++e)
    event_panels(page, played, e,
                 e == worst && first == played.begin() && (shown.front() == "P" || shown.front() == "Q"));
}

void parameters_part(report::Document& page, const std::vector<PageParameter>& parameters) {
  if (parameters.empty()) return;
  page.section("Parameters");
  const bool fitted = std::ranges::any_of(parameters, [](const auto& p) { return std::isfinite(p.low); });
  report::Table table{
      fitted
          ? "Values before and after the fit, with 95 % intervals. Variance reduction by the records: 1 − posterior "
            "variance / prior variance of the parameter."
          : "Model parameters (unchanged).",
      {"parameter", "unit", fitted ? "before" : "value"},
      {}};
  if (fitted)
    table.header.insert(table.header.end(), {"after", "95 % interval", "variance reduction", "note"});
  for (const PageParameter& p : parameters) {
    std::vector<report::Cell> row = {p.block + " " + p.symbol, p.unit, number_text(p.before)};
    if (fitted) {
      row.emplace_back(number_text(p.after));
      row.emplace_back(std::isfinite(p.low) ? fmt::format("{} … {}", number_text(p.low), number_text(p.high))
                                            : "–");
      row.emplace_back(std::isfinite(p.decided) ? fmt::format("{:.0f} %", 100 * p.decided) : "–");
      row.emplace_back(p.note);
    }
    table.rows.push_back(std::move(row));
  }
  page.add(table);
}

void errors_part(report::Document& page, const std::vector<Played>& played, const EventUse& use) {
  if (std::ranges::all_of(played, [](const Played& p) { return p.events.empty(); })) return;
  page.section("Error of each event");
  page.add(error_table(played, use));
}

void heat_maps(report::Document& page, const report::Table& map) {
  const auto column = std::ranges::find(map.header, "channel") - map.header.begin();
  page.text(map.caption);
  for (auto row = map.rows.begin(); row != map.rows.end();) {
    report::Table part{(*row)[static_cast<std::size_t>(column)].text, map.header, {}, true};
    part.header.erase(part.header.begin() + column);
    for (; row != map.rows.end() && (*row)[static_cast<std::size_t>(column)].text == part.caption; ++row) {
      part.rows.push_back(*row);
      part.rows.back().erase(part.rows.back().begin() + column);
    }
    page.add(std::move(part));
  }
}

void maps_part(report::Document& page, const std::vector<Played>& played) {
  page.section("Error map");
  for (const Played& p : played) {
    if (p.events.empty()) continue;
    const auto maps = maps_of(p.events);
    report::Table table = p.events.size() > 1 ? worst_map_table(maps) : map_table(maps);
    const std::string which = p.name == "model" ? "" : model_title(p.name) + ". ";
    page.text(which + map_sentence(maps));
    if (&p != played.data()) table.caption.clear();
    heat_maps(page, table);
  }
}

void glossary_part(report::Document& page) {
  page.add(report::Begin{report::Begin::Layout::fold, "Glossary"});
  page.add(report::Table{
      "",
      {"term", "definition"},
      {{"RMS", "Root mean square of modelled − measured over all samples that are compared."},
       {"noise σ",
        "Standard deviation of modelled − measured before the event, of the shown model. RMS / noise is "
        "the quotient of the two."},
       {"normalised RMS",
        "Root mean square of the residual's components (frequencies in the error map, whitened "
        "samples in a fit), each divided by its standard deviation under coloured noise. Noise "
        "alone gives 1. Its square is the reduced chi-square."},
       {"speed deviation [mHz]", "Deviation of the speed from nominal, times the nominal frequency."},
       {"Efd, Ifd [pu]",
        "Field voltage and field current per unit of the air-gap line: 1 pu gives rated terminal voltage at no load "
        "without saturation."},
       {"bin",
        "One time window and one frequency band of one channel in the error map. Noise alone "
        "stays below its bound."},
       {"evidence",
        "2 ln(Bayes factor) of the model with the effect against the model without it, penalised for the "
        "added parameters."},
       {"fit, verification",
        "Use of an event: the parameters were fitted to it, or it was held out and verifies the fit."},
       {"prior standard deviation",
        fmt::format("Relative to the model's value, before the records are used (--prior-sd, default {:g}).",
                    thresholds::parameters.prior_sd.value)},
       {"variance reduction",
        "Reduction of the parameter's variance by the records: 1 − posterior variance / prior variance."}}});
  page.add(report::End{});
}

std::string headline_of(const CommandPage& p) {
  if (!p.headline.empty()) return p.headline;
  const std::string model = p.played.size() > 1 ? model_title(p.played.back().name) : "Model";
  return headline(p.complete, p.played.back().fitness, model, remainder_of(p.played.back(), p.noise_alone));
}

std::string command_html(const CommandPage& p) {
  report::Document page{p.title, p.subtitle};
  first_screen(page, screen_of(p));
  page.section("Verdicts");
  page.add(report::Verdict{complete_text(p.complete, p.sentence),
                           p.complete ? report::Tone::good : report::Tone::bad});
  limits_part(page, p.played);
  if (p.handed_in) usability_part(page, *p.handed_in);
  maps_part(page, p.played);
  if (!p.tried.empty()) page.section("Hypotheses");
  for (const auto& sentence : p.tried) page.text(sentence);
  panels_part(page, p.played);
  if (p.handed_in) nameplate_part(page, *p.handed_in);
  parameters_part(page, p.parameters);
  errors_part(page, p.played, p.use);
  glossary_part(page);
  if (p.signatures) page.add(report::Signatures{{"Owner", "Reviewer"}});
  page.provenance(p.provenance);
  if (!p.figures.empty()) page.add(report::Data{"figures", p.figures});
  return report::html(page);
}

}  // namespace swingbank::validate::compare
