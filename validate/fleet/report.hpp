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

/// Sorts the rows, the worst first. The order of verdicts is unexplained, missing effect, adequate after
/// refit but not fit for purpose as submitted, failed, adequate. Rows with the same verdict are sorted by the
/// largest error of the submitted model [% of MVA], then by the normalised RMS of the refitted model, then by
/// name.
void sort_worst_first(std::vector<FleetRow>& rows);
/// Returns the table of all plants: verdict, missing effect, largest error and fitness of the submitted
/// model, normalised RMS (refitted and held out), and bound of the probability under noise.
report::Table fleet_table(const std::vector<FleetRow>& rows);
/// Returns for example "3 plants: 0 unexplained, 1 with a missing effect, 0 adequate after refit, 1 failed, 1
/// adequate."
std::string fleet_summary(const std::vector<FleetRow>& rows);
/// Returns the caution about false verdicts.
std::string fleet_caution(const std::vector<FleetRow>& rows);

std::string fleet_text(const std::vector<FleetRow>& rows);
std::string fleet_json(const Fleet& fleet, const std::vector<FleetRow>& rows);
/// Returns the CSV file. Its headings contain the units in brackets (validate/fleet/README.md lists the
/// columns).
std::string fleet_csv(const std::vector<FleetRow>& rows);
/// Returns the page. Its links to every plant's report.html are relative to the folder of the page.
std::string fleet_html(const Fleet& fleet, const std::vector<FleetRow>& rows);

/// Returns the exit code: 1 if any plant failed, otherwise 3 if any plant is not adequate, otherwise 0.
int fleet_code(const std::vector<FleetRow>& rows);

}  // namespace swingbank::validate::fleet
