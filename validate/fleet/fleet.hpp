#pragma once
// Diagnosis of a fleet of plants, each from its own records: result files of a plant, and reuse of finished
// results. The caller distributes the plants (jobs/fleet_run.hpp).
#include <map>
#include <nlohmann/json_fwd.hpp>

#include "validate/diagnose/diagnose.hpp"
#include "validate/fleet/fleet_file.hpp"

namespace swingbank::validate::fleet {

/// Row of the fleet's table.
struct FleetRow {
  std::string plant;
  std::string verdict;                          ///< verdict_name(), or "failed"
  std::vector<std::string> effects;             ///< as Diagnosis::effects
  std::vector<std::string> equivalent;          ///< as Diagnosis::equivalent
  std::map<std::string, double> probabilities;  ///< of the explanations in the credible set
  std::string side;
  double evidence = 0;  ///< 2 ln(Bayes factor) of the first effect; NaN: none was named
  double left = 0;      ///< normalised RMS of the refitted model without an effect
  double unseen_before = 0, unseen_after = 0;  ///< normalised RMS over held-out events; NaN: not judged
  double chance = 0;                           ///< bound of chance_of(); NaN: none was named
  int events = 0;
  std::string sentence;  ///< verdict, or the problems, one per line
  std::string inputs;    ///< hash of all inputs of the row
  [[nodiscard]] bool failed() const { return verdict == "failed"; }
  [[nodiscard]] bool adequate() const { return verdict == "adequate"; }
};
/// Row of a plant that could not be diagnosed, with the reason `why`.
FleetRow failed_row(const std::string& plant, const std::string& why);
nlohmann::json row_json(const FleetRow& row);
/// Reads a row. Throws InputError, naming `where`, if the text is not one.
FleetRow read_row(const std::string& text, const std::string& where);

/// Returns an upper bound of the probability that noise alone reduces the penalised chi-square by `fall` for
/// any of `hypotheses` wrong hypotheses. Twice the log likelihood ratio of `added` superfluous parameters is
/// chi-square distributed (Wilks); for structures with equally many parameters it exceeds g with probability
/// exp(-g/2) at most. The bound multiplies by the number of hypotheses (Bonferroni). It does not cover
/// instrument errors or an incomplete list of hypotheses.
double chance_of(double fall, int added, int hypotheses);

/// Result of one plant.
struct FleetOutcome {
  FleetRow row;
  bool was_there = false;  ///< taken from an earlier run
};
/// Diagnoses one plant and writes diagnosis.json, report.html, notes.txt (if there are notes) and plant.json
/// to OUT/<name>, all or none. If plant.json belongs to the same inputs, it is reused and nothing is
/// computed. A plant that cannot be diagnosed gets a row with the reason and a plant.json alone, and the next
/// run tries it again. Errors of inputs and of writing give a failed row, not an exception.
FleetOutcome diagnose_plant(const Fleet& fleet, const FleetPlant& plant, const std::filesystem::path& out,
                            const diagnose::DiagnoseOptions& options);

}  // namespace swingbank::validate::fleet
