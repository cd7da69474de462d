#pragma once
// A comparison as text for the terminal, as JSON, as CSV and as an HTML page.
#include <string>
#include <vector>

#include "validate/compare/compare.hpp"
#include "validate/compare/fitness.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::compare {

/// Normalised RMS per event, channel, window and band, and the RMS per window in units.
report::Table error_map(const std::vector<EventComparison>& events);

/// The verdict, what to do next, the errors and each note once, for a terminal; `verbose`: every table.
std::string terminal_report(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                            const Adequacy& adequacy, const Fitness& fitness, bool verbose);
/// Everything but the samples; values in pu, bases and units beside them.
std::string json_report(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                        const Adequacy& adequacy, const Fitness& fitness,
                        const report::Provenance& provenance);
/// The samples of one event: t, V, theta, and every channel measured and modelled.
std::string csv_playback(const EventComparison& event);
/// The self-contained page: verdict, tables, overlays, residuals, provenance.
std::string html_report(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                        const Adequacy& adequacy, const Fitness& fitness,
                        const report::Provenance& provenance);

/// Hashes of model and records, version and command line.
report::Provenance provenance(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                              const std::string& command_line);

}  // namespace swingbank::validate::compare
