#pragma once
// Error maps as tables for terminal and page, and as JSON.
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "validate/compare/error_map.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::compare {

struct EventComparison;

/// Error map with the names and units of its figures.
struct LabelledMap {
  std::string event, channel, unit;              ///< names of event and channel; unit of the RMS
  double scale = 1;                              ///< value of 1 pu [unit]
  const std::vector<Window>* windows = nullptr;  ///< windows of the map
  const ErrorMap* map = nullptr;                 ///< errors of this channel
  double size = 0;                               ///< nominal value [pu]; 0: unknown
};

/// Returns the map of each channel of each event, which must outlive the result.
std::vector<LabelledMap> maps_of(const std::vector<EventComparison>& events);

/// Table with one row per event, channel and window: RMS in the channel's unit, then the normalised RMS over
/// all frequencies and per band. A star marks values above their bound, "–" a band for which the window is
/// too short. The event column is omitted if there is one event only. `subject`: the name of an event.
report::Table map_table(const std::vector<LabelledMap>& maps, const std::string& subject = "event");
/// The same table with the worst event in each bin (highest normalised RMS / bound).
report::Table worst_map_table(const std::vector<LabelledMap>& maps, const std::string& subject = "event");

/// Sentence that names, per channel, the window and band furthest above the bound, and the number of events
/// in which this bin exceeds its bound.
std::string map_sentence(const std::vector<LabelledMap>& maps);

/// JSON rows, one per bin: window, band ("all": every frequency), values, rms_pu, normalised_rms and
/// normalised_bound.
nlohmann::json map_json(const std::vector<Window>& windows, const ErrorMap& map);

}  // namespace swingbank::validate::compare
