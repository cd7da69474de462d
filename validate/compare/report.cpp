#include "validate/compare/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/json.hpp"
#include "sim/plant/parameter_id.hpp"
#include "validate/compare/error_map_table.hpp"
#include "validate/compare/error_table.hpp"
#include "validate/compare/event_title.hpp"
#include "validate/compare/first_screen.hpp"
#include "validate/compare/page_parts.hpp"
#include "validate/compare/report_json.hpp"
#include "validate/thresholds/list.hpp"

namespace swingbank::validate::compare {
namespace {

/// Returns every parameter of a plant with its value.
std::vector<PageParameter> parameters_of(const sim::plant::Plant& plant) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<PageParameter> rows;
  for (int block = 0; block < sim::plant::block_count(plant); ++block)
    for (const auto id : sim::plant::parameters_of(plant, block)) {
      const sim::Parameter& p = sim::plant::parameter_record(plant, id);
      const double value = sim::plant::parameter_value(plant, id);
      rows.push_back({std::string(sim::plant::block_effect(plant, block).name), std::string(p.symbol),
                      std::string(p.unit), value, value, none, none, none});
    }
  return rows;
}

/// Text with each note once and the names of its events.
std::string notes_text(const std::vector<EventComparison>& events) {
  std::vector<std::pair<std::string, std::vector<std::string>>> notes;
  for (const auto& e : events)
    for (const auto& note : e.notes) {
      auto known = std::ranges::find(notes, note, &std::pair<std::string, std::vector<std::string>>::first);
      if (known == notes.end()) known = notes.insert(notes.end(), {note, {}});
      known->second.push_back(e.record.name);
    }
  std::string text;
  for (const auto& [note, of] : notes)
    text += fmt::format(
        "note ({}): {}\n",
        of.size() == events.size() && of.size() > 1 ? "all events" : fmt::format("{}", fmt::join(of, ", ")),
        note);
  return text;
}

nlohmann::json to_json(const WindowError& w) {
  nlohmann::json j = {{"samples", w.samples},
                      {"rms_pu", w.rms},
                      {"mean_pu", w.mean},
                      {"worst_pu", w.worst},
                      {"worst_at_s", w.worst_at}};
  j["rms_over_noise"] = w.in_noise;
  return j;
}

nlohmann::json to_json(const EventComparison& e) {
  nlohmann::json j = {{"record", e.record.name},
                      {"record_sha256", e.record.sha256},
                      {"begins", record::beginning(e.record)},
                      {"samples", e.record.samples()},
                      {"rate_per_s", e.record.rate()},
                      {"switchings_found", e.detected},
                      {"switchings_fitted", e.fitted},
                      {"start",
                       {{"P_pu", e.playback.start.P},
                        {"Q_pu", e.playback.start.Q},
                        {"V_pu", std::abs(e.playback.start.voltage)}}},
                      {"notes", e.notes}};
  j["switchings"] = j["channels"] = nlohmann::json::array();
  for (const auto& s : e.switchings)
    j["switchings"].push_back({{"t_s", s.time}, {"uncertainty_s", s.uncertainty}});
  for (const auto& c : e.channels) {
    nlohmann::json channel = {{"name", c.name},     {"unit", c.unit},      {"units_in_pu", c.scale},
                              {"judged", c.judged}, {"noise_pu", c.noise}, {"whole", to_json(c.whole)}};
    channel["windows"] = nlohmann::json::array();
    for (std::size_t w = 0; w < e.windows.size(); ++w) {
      auto window = to_json(c.windows[w]);
      window["name"] = e.windows[w].name;
      window["from_s"] = e.windows[w].from;
      window["to_s"] = e.windows[w].to;
      channel["windows"].push_back(window);
    }
    channel["map"] = map_json(e.windows, c.map);
    j["channels"].push_back(channel);
  }
  return j;
}

/// Returns the page of a comparison, without its JSON.
CommandPage page_of(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                    const Adequacy& adequacy, const Fitness& fitness, const HandedIn& handed,
                    const report::Provenance& rows) {
  CommandPage page;
  page.title = "Measured against modelled: " + model.name;
  page.subtitle = fmt::format(
      "{} of {:g} MVA; the recorded {} played into the model, and its response is compared with the recording.",
      plant::subject(model), model.plant.mva,
      model.whole                         ? "input signals of the component are"
      : events.front().playback.P.empty() ? "P and Q are"
                                          : "terminal voltage is");
  page.complete = adequacy.adequate;
  page.sentence = adequacy.sentence;
  page.played = {{"model", events, fitness}};
  page.handed_in = handed;
  page.signatures = true;
  page.parameters = parameters_of(model.plant);
  page.provenance = rows;
  if (!adequacy.adequate) page.next = next_command(rows, "diagnose");
  return page;
}

}  // namespace

std::string terminal_report(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                            const Adequacy& adequacy, const Fitness& fitness, const HandedIn& handed,
                            bool verbose) {
  std::string out = fitness.sentence + "\n" + complete_text(adequacy.adequate, adequacy.sentence) + "\n" +
                    handed_in_text(handed);
  if (!adequacy.adequate)
    out += "Next: swingbank diagnose, with the same options, names the missing component.\n";
  out += fmt::format("\n{} ({}): measured against modelled\n\n", model.name, plant::subject(model)) +
         error_text({{"", events, fitness}});
  const auto maps = maps_of(events);
  if (!adequacy.adequate) out += "\n" + map_sentence(maps) + "\n";
  if (verbose)
    out += (events.size() > 1 ? "\nNormalised RMS per window and band, worst of all events:\n" +
                                    report::padded(worst_map_table(maps))
                              : "\nNormalised RMS per window and band:\n" + report::padded(map_table(maps))) +
           "* = above the joint noise limit\n";
  out += "\n";
  for (const auto& e : events) {
    const auto begins = record::beginning(e.record);
    out += fmt::format("{}: {}{}\n", e.record.name, event_title(e),
                       begins.empty() ? "" : "; t = 0 is " + begins);
  }
  out += notes_text(events);
  if (!verbose) return out + "(--verbose prints the error map and every limit)\n";
  if (fitness.not_judged.empty())
    out += "\n" + worst_fitness_table(fitness).caption + "\n" + report::padded(worst_fitness_table(fitness));
  if (!fitness.movements.empty())
    out += "\n" + movement_table(fitness).caption + "\n" + report::padded(movement_table(fitness));
  return out;
}

std::string json_report(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                        const Adequacy& adequacy, const Fitness& fitness, const HandedIn& handed,
                        const report::Provenance& rows) {
  nlohmann::json j = {{"adequate", adequacy.adequate},
                      {"fitness", fitness_json(fitness)},
                      {"verdict", adequacy.sentence},
                      {"adequacy", thresholds::ruling_json(adequacy.ruling)},
                      {"bins", adequacy.bins},
                      {"bins_exceeding", adequacy.exceeding},
                      {"bins_uninformative", adequacy.vague},
                      {"false_alarm_probability", thresholds::adequacy.false_alarm.value},
                      {"base_mva", model.record_base.mva},
                      {"frequency_hz", model.record_base.frequency}};
  j["events"] = nlohmann::json::array();
  for (const auto& e : events) j["events"].push_back(to_json(e));
  add_report(j, "compare", page_of(model, events, adequacy, fitness, handed, rows));
  return json_text(j, 2) + "\n";
}

std::string csv_playback(const EventComparison& e) {
  std::string out = "t_s,V_pu,theta_rad";
  for (const auto& c : e.channels) out += fmt::format(",{0}_measured_pu,{0}_modelled_pu", c.name);
  if (e.record.epoch) out += ",utc";
  out += "\n";
  for (std::size_t k = 0; k < e.record.t.size(); ++k) {
    out += fmt::format("{:.9g},{:.9g},{:.9g}", e.record.t[k], e.record.V[k], e.record.theta[k]);
    for (const auto& c : e.channels) out += fmt::format(",{:.9g},{:.9g}", c.measured[k], c.modelled[k]);
    if (e.record.epoch) out += "," + record::utc_text(*e.record.epoch + e.record.t[k]);
    out += "\n";
  }
  return out;
}

std::string html_report(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                        const Adequacy& adequacy, const Fitness& fitness, const HandedIn& handed,
                        const report::Provenance& rows) {
  CommandPage page = page_of(model, events, adequacy, fitness, handed, rows);
  page.figures = json_report(model, events, adequacy, fitness, handed, rows);
  return command_html(page);
}

report::Provenance provenance(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                              const std::string& command_line) {
  report::Provenance rows = {
      {"command", command_line}, {"software", "swingbank " SWINGBANK_VERSION}, {"model", model.origin}};
  rows.emplace_back(
      "conventions",
      fmt::format(
          "{}; {}; {:g} Hz",
          model.conventions.speed_voltage ? "speed variation included in the stator voltage equations"
                                          : "speed variation neglected in the stator voltage equations",
          model.conventions.mechanical_power ? "constant mechanical power" : "constant mechanical torque",
          model.conventions.frequency));
  if (!model.defaults.empty())
    rows.emplace_back("default values", fmt::format("{}", fmt::join(model.defaults, ", ")));
  for (const auto& e : events)
    rows.emplace_back("record", e.record.name + (e.record.epoch ? ", begins " + record::beginning(e.record)
                                                                : std::string()));
  return rows;
}

}  // namespace swingbank::validate::compare
