#pragma once
// The table of a fleet: for a terminal, as JSON, CSV and page. It holds no times and nothing of how the work
// was spread, so that the same fleet gives the same bytes however often a run was interrupted.
#include <string>
#include <vector>

#include "validate/fleet/fleet.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::fleet {

/// Plant, verdict, effect, side, evidence, errors, chance; a failed plant has its first problem instead.
report::Table fleet_table(const std::vector<FleetRow>& rows);
/// "3 plants: 1 adequate, 1 with an effect named, 1 unexplained, 0 failed."
std::string fleet_summary(const std::vector<FleetRow>& rows);
/// What a reader must know of false verdicts.
std::string fleet_caution(const std::vector<FleetRow>& rows);

std::string fleet_text(const std::vector<FleetRow>& rows);
std::string fleet_json(const Fleet& fleet, const std::vector<FleetRow>& rows);
std::string fleet_csv(const std::vector<FleetRow>& rows);
/// Links to every plant's report.html, relative to the folder of the page.
std::string fleet_html(const Fleet& fleet, const std::vector<FleetRow>& rows);

/// 0: all adequate, 3: some plant is not, 1: some plant failed.
int fleet_code(const std::vector<FleetRow>& rows);

}  // namespace swingbank::validate::fleet
