#pragma once
// Error maps as tables for terminal and page, and as JSON.
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "validate/compare/error_map.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::compare {

/// A map and what its numbers mean.
struct LabelledMap {
  std::string event, channel, unit;
  double scale = 1;  ///< units in 1 pu
  const std::vector<Window>* windows = nullptr;
  const ErrorMap* map = nullptr;
};

/// One row per event, channel and window; columns: RMS in units, then the normalised RMS over all frequencies
/// and per band. A star marks what exceeds its bound; "–" a band the window cannot hold. The event's column
/// is left out where all are of one event.
report::Table map_table(const std::vector<LabelledMap>& maps);
/// The same with the worst of all events (furthest beyond its bound) in each cell.
report::Table worst_map_table(const std::vector<LabelledMap>& maps);

/// The maps in words: of each channel the window and band that are furthest beyond their bound, and in how
/// many events they are beyond it.
std::string map_sentence(const std::vector<LabelledMap>& maps);

/// Rows of cells: window, band ("all" over every frequency), values, rms_pu, normalised_rms and
/// normalised_bound.
nlohmann::json map_json(const std::vector<Window>& windows, const ErrorMap& map);

/// "0.9 ×", "85 ×", "–" where it is not known.
std::string times_noise(double ratio);

}  // namespace swingbank::validate::compare
