#pragma once
// Diagnosis of one plant of a fleet from its own records: its result files, and reuse of finished results.
// The caller distributes the plants (jobs/fleet_run.hpp).
#include "validate/diagnose/diagnose.hpp"
#include "validate/fleet/fleet_file.hpp"
#include "validate/fleet/row.hpp"

namespace swingbank::validate::fleet_plant {

/// Returns an upper bound of the probability that noise alone reduces the penalised chi-square by `fall` for
/// any of `hypotheses` wrong hypotheses. Twice the log likelihood ratio of `added` superfluous parameters is
/// chi-square distributed (Wilks); for structures with equally many parameters it exceeds g with probability
/// exp(-g/2) at most. The bound multiplies by the number of hypotheses (Bonferroni). It does not cover
/// instrument errors or an incomplete list of hypotheses.
double chance_of(double fall, int added, int hypotheses);

/// Result of one plant.
struct FleetOutcome {
  fleet::FleetRow row;
  bool was_there = false;  ///< taken from an earlier run
};
/// Diagnoses one plant and writes diagnosis.json, report.html, notes.txt (if there are notes) and plant.json
/// to OUT/<name>, all or none. If plant.json belongs to the same inputs, it is reused and nothing is
/// computed. A plant that cannot be diagnosed gets a row with the reason and a plant.json alone, and the next
/// run tries it again. Errors of inputs and of writing give a failed row, not an exception.
FleetOutcome diagnose_plant(const fleet::Fleet& fleet, const fleet::FleetPlant& plant,
                            const std::filesystem::path& out, const diagnose::DiagnoseOptions& options);

}  // namespace swingbank::validate::fleet_plant
