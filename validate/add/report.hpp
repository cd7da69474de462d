#pragma once
// An addition as text for the terminal and as JSON.
#include <string>
#include <vector>

#include "base/json.hpp"
#include "validate/add/add.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::add {

/// Event, seen or unseen, channel: rms in MW or Mvar and misfit before, refitted without the effect, after.
report::Table addition_table(const Addition& a);
std::string terminal_report(const Addition& a);
nlohmann::json addition_json(const Addition& a);
/// Where the values come from: head comment of the plant file.
std::vector<std::string> provenance_lines(const Addition& a, const plant::PlantModel& from,
                                          const std::string& command_line);

std::string terminal_report(const Completion& c);
nlohmann::json completion_json(const Completion& c);

}  // namespace swingbank::validate::add
