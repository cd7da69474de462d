#pragma once
// Common part of the JSON results of compare, calibrate and add: docs/reference/report.schema.json.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "validate/compare/page_parts.hpp"

namespace swingbank::validate::compare {

/// Name and version of the format. The version changes if a key of the schema is removed or changes meaning.
constexpr const char* kReportFormat = "swingbank-report-2";

/// Adds the common part of a command's JSON to its own keys: format, command, software, model, nameplate,
/// verdicts, usability, errors with units, provenance, and the use of each of `events`. `kind`: the command.
/// Throws std::logic_error if the page has no submitted model (CommandPage::handed_in).
void add_report(nlohmann::json& result, const std::string& kind, const CommandPage& page);

}  // namespace swingbank::validate::compare
