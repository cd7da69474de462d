#include "validate/compare/report_json.hpp"

#include <algorithm>
#include <stdexcept>

#include "base/json.hpp"
#include "validate/compare/error_table.hpp"

namespace swingbank::validate::compare {
namespace {

/// Returns the value of a line of the provenance; empty if there is none.
std::string value_of(const report::Provenance& rows, const std::string& name) {
  const auto row = std::ranges::find(rows, name, &report::Provenance::value_type::first);
  return row == rows.end() ? "" : row->second;
}

/// Adds the use of each event, and the events that are missing in the command's own part.
void add_events(nlohmann::json& result, const CommandPage& page) {
  nlohmann::json& events = result["events"];
  if (!events.is_array()) events = nlohmann::json::array();
  for (const Played& played : page.played)
    for (const EventComparison& e : played.events)
      if (std::ranges::none_of(events, [&](const auto& j) { return j["record"] == e.record.name; }))
        events.push_back({{"record", e.record.name}});
  for (auto& event : events) event["use"] = page.use.of(event["record"].get<std::string>());
}

}  // namespace

void add_report(nlohmann::json& result, const std::string& kind, const CommandPage& page) {
  if (!page.handed_in) throw std::logic_error("a report without a model");
  const HandedIn& model = *page.handed_in;
  const Fitness& fitness = page.played.back().fitness;
  result["format"] = kReportFormat;
  result["kind"] = kind;
  result["command"] = value_of(page.provenance, "command");
  result["software"] = value_of(page.provenance, "software");
  result["model"] = {
      {"name", model.name}, {"file", model.file}, {"sha256", model.sha256}, {"mva", model.mva}};
  result["nameplate"] = nameplate_json(model);
  result["headline"] = headline_of(page);
  result["sentence"] = page.sentence;
  result["statistically_complete"] = page.complete;
  result["fit_for_purpose"] = fitness.not_judged.empty() ? nlohmann::json(fitness.fit) : nullptr;
  result["usability"] = usability::usability_json(model.usability);
  result["errors"] = errors_json(page.played);
  result["provenance"] = nlohmann::json::array();
  for (const auto& [name, value] : page.provenance)
    result["provenance"].push_back({{"what", name}, {"value", value}});
  add_events(result, page);
}

}  // namespace swingbank::validate::compare
