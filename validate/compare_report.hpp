#pragma once
// A comparison as text for the terminal, as JSON, as CSV and as an HTML page.
#include <string>
#include <vector>

#include "validate/compare.hpp"
#include "validate/page.hpp"

namespace swingbank::validate {

/// Error per event, channel and window: rows of the map, in MW or Mvar and in units of the noise.
Table error_map(const std::vector<EventComparison>& events);
/// RMS, mean and largest error per event and channel over the whole record, with units.
Table error_summary(const std::vector<EventComparison>& events);

/// Both tables and the notes, for a terminal.
std::string terminal_report(const PlantModel& model, const std::vector<EventComparison>& events);
/// Everything but the samples; values in pu, bases and units beside them.
std::string json_report(const PlantModel& model, const std::vector<EventComparison>& events,
                        const Provenance& provenance);
/// The samples of one event: t, V, theta, measured and modelled P and Q.
std::string csv_playback(const EventComparison& event);
/// The self-contained page: tables, overlays, residuals, provenance.
std::string html_report(const PlantModel& model, const std::vector<EventComparison>& events,
                        const Provenance& provenance);

/// Hashes of model and records, version and command line.
Provenance provenance(const PlantModel& model, const std::vector<EventComparison>& events,
                      const std::string& command_line);

}  // namespace swingbank::validate
