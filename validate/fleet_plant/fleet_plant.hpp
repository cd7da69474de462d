#pragma once
// Diagnosis of one plant of a fleet from its own records: its result files, and reuse of finished results.
// The caller distributes the plants (jobs/fleet_run.hpp).
#include "validate/diagnose/diagnose.hpp"
#include "validate/fleet/fleet_file.hpp"
#include "validate/fleet/row.hpp"

namespace swingbank::validate::fleet_plant {

/// Returns an upper bound of the probability that noise alone reduces the penalised chi-square by `fall` for
/// any of `hypotheses` wrong hypotheses. Twice the log likelihood ratio of `added` superfluous parameters is
/// chi-square distributed (Wilks). For two structures with the same number of parameters, it exceeds g with a
/// probability of at most exp(-g/2). The probability is multiplied by the number of hypotheses (Bonferroni).
/// The bound does not cover instrument errors or an incomplete list of hypotheses.
double chance_of(double fall, int added, int hypotheses);

/// Result of one plant.
struct FleetOutcome {
  fleet::FleetRow row;
  bool was_there = false;  ///< whether the row is from an earlier run
};
/// Diagnoses one plant and writes diagnosis.json, report.html, notes.txt (if there are notes) and plant.json
/// to OUT/<name>, either all of them or none. If an earlier run with the same inputs has finished, its row is
/// returned and nothing is computed. A plant that cannot be diagnosed gets a row with the reason. Its folder
/// then contains plant.json only, and the next run tries it again. Any exception gives a failed row and is
/// not passed on.
FleetOutcome diagnose_plant(const fleet::Fleet& fleet, const fleet::FleetPlant& plant,
                            const std::filesystem::path& out, const diagnose::DiagnoseOptions& options);

}  // namespace swingbank::validate::fleet_plant
