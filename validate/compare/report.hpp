#pragma once
// Report of a comparison as terminal text, JSON, CSV and HTML page.
#include <string>
#include <vector>

#include "validate/compare/compare.hpp"
#include "validate/compare/fitness.hpp"
#include "validate/compare/handed_in.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::compare {

/// Terminal text: verdicts, usability, next step, errors, titles and notes; with `verbose` also every table.
std::string terminal_report(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                            const Adequacy& adequacy, const Fitness& fitness, const HandedIn& handed,
                            bool verbose);
/// JSON of all results except the samples, including the part of add_report(). Values are in pu, with bases
/// and units.
std::string json_report(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                        const Adequacy& adequacy, const Fitness& fitness, const HandedIn& handed,
                        const report::Provenance& provenance);
/// CSV of the samples of one event: t, V, theta, and every channel measured and simulated.
std::string csv_playback(const EventComparison& event);
/// Self-contained page: verdicts, tables, curves, residuals, provenance.
std::string html_report(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                        const Adequacy& adequacy, const Fitness& fitness, const HandedIn& handed,
                        const report::Provenance& provenance);

/// Command line, version, model, conventions, default parameter values and records.
report::Provenance provenance(const plant::PlantModel& model, const std::vector<EventComparison>& events,
                              const std::string& command_line);

}  // namespace swingbank::validate::compare
