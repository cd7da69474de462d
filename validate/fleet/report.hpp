#pragma once
// Report of a fleet as terminal text, JSON, CSV and page. It contains neither times nor the distribution of
// the work, so that interrupted and uninterrupted runs give identical files. The rows are in the order of
// sort_worst_first().
#include <string>
#include <vector>

#include "validate/fleet/fleet_file.hpp"
#include "validate/fleet/row.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::fleet {

/// Sorts the rows, the worst first: by verdict (unexplained, missing effect, adequate after refit but not
/// fit for purpose as submitted, failed, adequate), then by the largest error of the submitted model [% of
/// MVA], the normalised RMS of the refitted one, and the name.
void sort_worst_first(std::vector<FleetRow>& rows);
/// Table: plant, verdict, missing effect, side, largest error of the submitted model, fitness for purpose,
/// errors [multiples of the noise], chance.
report::Table fleet_table(const std::vector<FleetRow>& rows);
/// "3 plants: 0 unexplained, 1 with a missing effect, 0 adequate after refit, 1 failed, 1 adequate."
std::string fleet_summary(const std::vector<FleetRow>& rows);
/// Caution about false verdicts.
std::string fleet_caution(const std::vector<FleetRow>& rows);

std::string fleet_text(const std::vector<FleetRow>& rows);
std::string fleet_json(const Fleet& fleet, const std::vector<FleetRow>& rows);
/// CSV with a heading, units in brackets (validate/fleet/README.md describes the columns).
std::string fleet_csv(const std::vector<FleetRow>& rows);
/// Page with links to every plant's report.html, relative to its folder.
std::string fleet_html(const Fleet& fleet, const std::vector<FleetRow>& rows);

/// Exit code: 0 all adequate, 3 some plant is not, 1 some plant failed.
int fleet_code(const std::vector<FleetRow>& rows);

}  // namespace swingbank::validate::fleet
