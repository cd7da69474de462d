#pragma once
// Report of an addition as text for the terminal and as JSON.
#include <string>
#include <vector>

#include "base/json.hpp"
#include "validate/add/add.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::add {

/// Returns the table of events (fit or verification): reduced chi-square of the given model, refitted without
/// the effect, and with it, and the limit.
report::Table addition_table(const Addition& a);
/// Returns the result as text for the terminal.
std::string terminal_report(const Addition& a);
/// Returns the result as JSON.
nlohmann::json addition_json(const Addition& a);
/// Returns the head comment of the plant file: the source of the values.
std::vector<std::string> provenance_lines(const Addition& a, const plant::PlantModel& from,
                                          const std::string& command_line);

/// Returns the result of a completion as text for the terminal.
std::string terminal_report(const Completion& c);
/// Returns the result of a completion as JSON.
nlohmann::json completion_json(const Completion& c);

}  // namespace swingbank::validate::add
