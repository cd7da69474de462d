#pragma once
// A calibration as text for the terminal and as JSON.
#include <string>
#include <vector>

#include "base/json.hpp"
#include "validate/calibrate/calibrate.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::calibrate {

/// Parameters: start, value, standard error, 95 % interval, share decided by the records.
report::Table parameter_table(const Calibration& c);
/// Event and channel: rms before and after in MW or Mvar, misfit with its limit, seen or unseen.
report::Table event_table(const std::vector<EventScore>& events);
/// A table for a terminal: columns aligned, the first to the left.
std::string aligned(const report::Table& table);

/// Verdict, tables, what cannot be told and which event would tell it.
std::string terminal_report(const Calibration& c);
nlohmann::json calibration_json(const Calibration& c);
nlohmann::json event_json(const EventScore& e);
/// Where the values come from: head comment of the plant file.
std::vector<std::string> provenance_lines(const Calibration& c, const std::string& command_line);
std::string adequacy_name(Adequacy adequacy);
/// What a blur says, as a sentence.
std::string describe(const Calibration& c, const Blur& blur);

}  // namespace swingbank::validate::calibrate
