#pragma once
// Calibration report as terminal text and JSON.
#include <string>
#include <vector>

#include "base/json.hpp"
#include "validate/calibrate/calibrate.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::calibrate {

/// Table of parameters: start, value, standard error, 95 % interval, variance reduction by the records.
report::Table parameter_table(const Calibration& c);
/// Returns the use of an event: "fit" or "verification".
std::string use_name(const EventScore& e);
/// Table of events: use, reduced chi-square before and after the calibration, and its limit.
report::Table event_table(const std::vector<EventScore>& events);

/// Verdict, tables, parameters that are not identified, and events that would identify them.
std::string terminal_report(const Calibration& c);
/// Returns the calibration as JSON.
nlohmann::json calibration_json(const Calibration& c);
/// Returns the scores of one event as JSON.
nlohmann::json event_json(const EventScore& e);
/// Origin of the values, for the head comment of the plant file.
std::vector<std::string> provenance_lines(const Calibration& c, const std::string& command_line);
/// Returns the name of the verdict, as in the JSON.
std::string adequacy_name(Adequacy adequacy);
/// Sentence that describes an unidentified parameter combination.
std::string describe(const Calibration& c, const UnidentifiedCombination& combination);

}  // namespace swingbank::validate::calibrate
