#include "validate/compare/page_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "validate/compare/error_map_table.hpp"
#include "validate/compare/error_table.hpp"
#include "validate/compare/event_title.hpp"

namespace swingbank::validate::compare {
namespace {

constexpr const char* kInk = "#5b6b7b";
/// Colours of the models in their order: the submitted model is red.
constexpr std::array kModelColours = {"#c0392b", "#0b5cad", "#b8860b"};

std::string number_text(double v) { return std::isfinite(v) ? fmt::format("{:.4g}", v) : "–"; }

const ChannelComparison* find_channel(const EventComparison& e, const std::string& name) {
  const auto c = std::ranges::find(e.channels, name, &ChannelComparison::name);
  return c == e.channels.end() ? nullptr : &*c;
}

/// Comparisons of one event by all models that can follow it; the first provides the measured curves.
struct ShownEvent {
  std::vector<std::pair<const Played*, const EventComparison*>> of;
  [[nodiscard]] const EventComparison& first() const { return *of.front().second; }
};
ShownEvent shown_event(const std::vector<Played>& played, std::size_t event) {
  ShownEvent shown;
  for (const Played& p : played)
    if (event < p.events.size()) shown.of.emplace_back(&p, &p.events[event]);
  return shown;
}
const char* colour_of(const std::vector<Played>& played, const Played* one) {
  return kModelColours[static_cast<std::size_t>(one - played.data()) % kModelColours.size()];
}

std::vector<double> times(std::vector<double> values, double scale, double shift = 0) {
  for (auto& v : values) v = v * scale + shift;
  return values;
}

/// Returns an empty chart of an event.
report::Curves chart_of(const EventComparison& e, const std::string& title, const std::string& unit) {
  report::Curves c{title, "t [s]", "[" + unit + "]", e.record.name, e.record.t, {}, {}};
  if (!e.switchings.empty()) c.bands = {{e.switchings.front().time, e.switchings.back().time}};
  return c;
}

/// Chart of one channel: measured, and simulated by each model.
void channel_panel(report::Page& page, const std::vector<Played>& played, const ShownEvent& shown,
                   const std::string& name, double shift = 0) {
  const ChannelComparison* measured = find_channel(shown.first(), name);
  if (!measured) return;
  report::Curves c = chart_of(shown.first(), name, measured->unit);
  c.series.push_back({"measured", kInk, true, times(measured->measured, measured->scale, shift)});
  for (const auto& [model, event] : shown.of)
    if (const ChannelComparison* m = find_channel(*event, name))
      c.series.push_back({model->name, colour_of(played, model), false, times(m->modelled, m->scale, shift)});
  page.curves(c);
}

/// Chart of a recorded quantity that is played in.
void input_panel(report::Page& page, const EventComparison& e, const std::string& name,
                 const std::string& unit, std::vector<double> values) {
  if (values.size() != e.record.t.size()) return;  // not recorded
  report::Curves c = chart_of(e, name + ", played in", unit);
  c.series.push_back({"measured", kInk, true, std::move(values)});
  page.curves(c);
}

void voltage_panels(report::Page& page, const std::vector<Played>& played, const ShownEvent& shown) {
  const EventComparison& e = shown.first();
  if (find_channel(e, "V"))
    channel_panel(page, played, shown, "V");
  else
    input_panel(page, e, "V", "pu", e.record.V);
  const double nominal = e.record.base.frequency;
  if (!e.record.f.empty())
    input_panel(page, e, "f", "Hz", times(e.record.f, nominal, nominal));
  else if (e.record.angle != record::AngleSource::none && e.record.theta.size() == e.record.t.size())
    input_panel(page, e, "f from the angle", "Hz",
                times(frequency_of(e.record.t, e.record.theta, nominal), nominal, nominal));
  else
    page.note("f: neither frequency nor angle was recorded.");
}

void power_panels(report::Page& page, const std::vector<Played>& played, const ShownEvent& shown) {
  const record::Record& r = shown.first().record;
  for (const char* name : {"P", "Q"}) {
    const auto& recorded = name[0] == 'P' ? r.P : r.Q;
    if (find_channel(shown.first(), name))
      channel_panel(page, played, shown, name);
    else if (!recorded.empty())
      input_panel(page, shown.first(), name, name[0] == 'P' ? "MW" : "Mvar", times(recorded, r.base.mva));
  }
}

/// Charts of the residuals of P and Q.
void residual_panels(report::Page& page, const std::vector<Played>& played, const ShownEvent& shown) {
  for (const char* name : {"P", "Q"}) {
    const ChannelComparison* first = find_channel(shown.first(), name);
    if (!first) continue;
    report::Curves c = chart_of(shown.first(), fmt::format("{}, modelled − measured", name), first->unit);
    for (const auto& [model, event] : shown.of)
      if (const ChannelComparison* m = find_channel(*event, name))
        c.series.push_back({model->name, colour_of(played, model), false, times(m->residual, m->scale)});
    page.curves(c);
  }
}

std::string switching_times_text(const EventComparison& e) {
  std::string text;
  for (const auto& s : e.switchings) text += fmt::format("{}{:.4f} s", text.empty() ? "" : ", ", s.time);
  return text.empty() ? "none"
                      : text + (!e.detected ? " (given)"
                                : e.fitted  ? " (estimated and fitted)"
                                            : " (found)");
}

void event_panels(report::Page& page, const std::vector<Played>& played, std::size_t event) {
  const ShownEvent shown = shown_event(played, event);
  if (shown.of.empty()) return;
  const EventComparison& e = *shown.of.back().second;  // title and notes are those of the last model
  page.subsection(e.record.name + ": " + event_title(e));
  const auto begins = record::beginning(e.record);
  page.text(fmt::format(
      "{}{} samples at {:.6g} per second. Switching: {}. Start: P = {:.2f} MW, Q = {:.2f} Mvar, V = {:.4f} pu.",
      begins.empty() ? "" : "t = 0 is " + begins + ". ", e.record.samples(), e.record.rate(),
      switching_times_text(e), e.playback.start.P * e.record.base.mva, e.playback.start.Q * e.record.base.mva,
      std::abs(e.playback.start.voltage)));
  for (const auto& note : e.notes) page.note(note);
  page.begin_panels();
  voltage_panels(page, played, shown);
  power_panels(page, played, shown);
  for (const auto& c : e.channels)
    if (c.name != "V" && c.name != "frequency" && c.name != "P" && c.name != "Q")
      channel_panel(page, played, shown, c.name);
  residual_panels(page, played, shown);
  page.end_panels();
}

std::vector<LabelledMap> labelled_maps(const std::vector<EventComparison>& events) {
  std::vector<LabelledMap> maps;
  for (const auto& e : events)
    for (const auto& c : e.channels)
      maps.push_back({e.record.name, c.name, c.unit, c.scale, &e.windows, &c.map});
  return maps;
}

}  // namespace

void verdict_part(report::Page& page, const std::vector<Played>& played, bool complete,
                  const std::string& sentence, report::Tone tone) {
  using report::Tone;
  if (!played.empty()) {
    const Fitness& counts = played.back().fitness;
    const std::string who = played.size() > 1 ? fmt::format(" ({})", played.back().name) : "";
    page.verdict(counts.sentence + who, !counts.not_judged.empty() ? Tone::found
                                        : counts.fit               ? Tone::good
                                                                   : Tone::bad);
  }
  page.verdict(complete_text(complete, sentence), tone);
  for (std::size_t k = 0; k + 1 < played.size(); ++k)
    page.text(fmt::format("The model {}: {}", played[k].name == "submitted" ? "as submitted" : played[k].name,
                          played[k].fitness.sentence));
  if (!played.empty() && played.back().fitness.not_judged.empty())
    page.table(worst_fitness_table(played.back().fitness));
  if (!played.empty() && !played.back().fitness.movements.empty())
    page.table(movement_table(played.back().fitness));
}

void panels_part(report::Page& page, const std::vector<Played>& played) {
  std::size_t events = 0;
  for (const Played& p : played) events = std::max(events, p.events.size());
  if (events == 0) return;
  page.section("Events");
  page.hint(
      "Drag across a chart to zoom in on a time range (all charts of an event follow); "
      "double-click to see the whole record. The shaded band is the fault.");
  for (std::size_t e = 0; e < events; ++e) event_panels(page, played, e);
}

void parameters_part(report::Page& page, const std::vector<PageParameter>& parameters) {
  if (parameters.empty()) return;
  page.section("Parameters");
  const bool fitted = std::ranges::any_of(parameters, [](const auto& p) { return std::isfinite(p.low); });
  report::Table table{
      fitted ? "Values before and after the fit, with 95 % intervals and the share of the interval that "
               "the records determine."
             : "Model parameters (unchanged).",
      {"parameter", "unit", fitted ? "before" : "value"},
      {}};
  if (fitted)
    table.header.insert(table.header.end(), {"after", "95 % interval", "determined by records", "note"});
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
  page.table(table);
}

void errors_part(report::Page& page, const std::vector<Played>& played,
                 const std::vector<std::string>& unseen) {
  if (std::ranges::all_of(played, [](const Played& p) { return p.events.empty(); })) return;
  page.section("Error of each event");
  page.table(error_table(played, unseen));
}

void maps_part(report::Page& page, const std::vector<Played>& played) {
  page.section("Error map");
  for (const Played& p : played) {
    if (p.events.empty()) continue;
    const auto maps = labelled_maps(p.events);
    report::Table table = p.events.size() > 1 ? worst_map_table(maps) : map_table(maps);
    const std::string which = p.name == "model" ? "" : fmt::format("The model {}. ", p.name);
    page.text(which + map_sentence(maps));
    table.caption = which + (&p == played.data() ? table.caption : "Same units.");
    page.table(table);
  }
}

void glossary_part(report::Page& page) {
  page.section("Glossary");
  page.table(
      {"",
       {"term", "definition"},
       {{"RMS", "Root mean square of modelled − measured over all samples that are compared."},
        {"noise σ",
         "Standard deviation of modelled − measured before the event, of the model that is played. RMS / noise is "
         "the quotient of the two."},
        {"normalised RMS",
         "Root mean square of the residual's components (frequencies in the error map, whitened "
         "samples in a fit), each divided by its standard deviation under coloured noise. Noise "
         "alone gives 1. Its square is the reduced chi-square."},
        {"bin",
         "One time window and one frequency band of one channel in the error map. Noise alone "
         "stays below its bound."},
        {"evidence",
         "2 ln(Bayes factor) of the model with the effect against the model without it, penalised for the "
         "added parameters."},
        {"prior", "Standard deviation of a parameter before the records were used (--spread)."},
        {"determined",
         "Share of a parameter's interval that is determined by the records, not by the prior."}}});
}

std::string command_html(const CommandPage& p) {
  report::Page page(p.title, p.subtitle);
  verdict_part(page, p.played, p.complete, p.sentence, p.complete ? report::Tone::good : report::Tone::bad);
  maps_part(page, p.played);
  panels_part(page, p.played);
  parameters_part(page, p.parameters);
  errors_part(page, p.played, p.unseen);
  if (!p.tried.empty()) page.section("Hypotheses");
  for (const auto& sentence : p.tried) page.text(sentence);
  glossary_part(page);
  page.provenance(p.provenance);
  if (!p.figures.empty()) page.data("figures", p.figures);
  return page.html();
}

}  // namespace swingbank::validate::compare
