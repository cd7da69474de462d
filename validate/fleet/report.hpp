#pragma once
// Report of a fleet as terminal text, JSON, CSV and page. It contains neither times nor the distribution of
// the work, so that interrupted and uninterrupted runs give identical files.
#include <string>
#include <vector>

#include "validate/fleet/fleet_file.hpp"
#include "validate/fleet/row.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::fleet {

/// Table: plant, verdict, effect, side, evidence, errors, chance; a failed plant has its first problem
/// instead.
report::Table fleet_table(const std::vector<FleetRow>& rows);
/// "3 plants: 1 adequate, 1 with an effect named, 1 unexplained, 0 failed."
std::string fleet_summary(const std::vector<FleetRow>& rows);
/// Caution about false verdicts.
std::string fleet_caution(const std::vector<FleetRow>& rows);

std::string fleet_text(const std::vector<FleetRow>& rows);
std::string fleet_json(const Fleet& fleet, const std::vector<FleetRow>& rows);
std::string fleet_csv(const std::vector<FleetRow>& rows);
/// Page with links to every plant's report.html, relative to its folder.
std::string fleet_html(const Fleet& fleet, const std::vector<FleetRow>& rows);

/// Exit code: 0 all adequate, 3 some plant is not, 1 some plant failed.
int fleet_code(const std::vector<FleetRow>& rows);

}  // namespace swingbank::validate::fleet
