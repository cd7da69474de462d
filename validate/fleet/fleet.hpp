#pragma once
// A fleet: many plants, each diagnosed from its own records. What one plant's diagnosis leaves behind, and
// when it need not be made again. Who computes which plant is for the caller (jobs/fleet_run.hpp).
#include <map>
#include <nlohmann/json_fwd.hpp>

#include "validate/diagnose/diagnose.hpp"
#include "validate/fleet/fleet_file.hpp"

namespace swingbank::validate::fleet {

/// One row of the fleet's table.
struct FleetRow {
  std::string plant;
  std::string verdict;                          ///< verdict_name(), or "failed"
  std::vector<std::string> effects;             ///< as Diagnosis::effects
  std::vector<std::string> equivalent;          ///< as Diagnosis::equivalent
  std::map<std::string, double> probabilities;  ///< of what is in the set
  std::string side;
  double evidence = 0;                         ///< of the first effect; NaN: none was named
  double left = 0;                             ///< error after refitting the model as it is [noise]
  double unseen_before = 0, unseen_after = 0;  ///< RMS over all unseen events [noise]; NaN: not judged
  double chance = 0;                           ///< bound, see chance_of(); NaN: nothing was named
  int events = 0;
  std::string sentence;  ///< the verdict, or what went wrong, a problem per line
  std::string inputs;    ///< hash of everything the row depends on
  [[nodiscard]] bool failed() const { return verdict == "failed"; }
  [[nodiscard]] bool adequate() const { return verdict == "adequate"; }
};
/// The row of a plant that could not be diagnosed, and why.
FleetRow failed_row(const std::string& plant, const std::string& why);
nlohmann::json row_json(const FleetRow& row);
/// Throws InputError naming `where` if the text is no row.
FleetRow read_row(const std::string& text, const std::string& where);

/// Upper bound of the probability that noise alone lets chi2 (and beliefs) fall so far for any of
/// `hypotheses` that are wrong: twice the log likelihood ratio of `added` superfluous parameters is
/// chi-square distributed (Wilks), that of two structures with equally many parameters exceeds g with at most
/// exp(-g/2); times the number of hypotheses (Bonferroni). Errors of the instruments and of the list are not
/// in it.
double chance_of(double fall, int added, int hypotheses);

/// What was done for one plant.
struct FleetOutcome {
  FleetRow row;
  bool was_there = false;  ///< an earlier run had finished it
};
/// Diagnoses one plant into OUT/<name>: diagnosis.json, report.html, notes.txt if there is something to note,
/// and plant.json, all or none. Nothing is computed if plant.json says that the same inputs were diagnosed
/// already. A plant that cannot be diagnosed gets a row that says why, and a plant.json alone; it is tried
/// again next time. Never throws for what inputs hold; also what cannot be written is a failed row.
FleetOutcome diagnose_plant(const Fleet& fleet, const FleetPlant& plant, const std::filesystem::path& out,
                            const diagnose::DiagnoseOptions& options);

}  // namespace swingbank::validate::fleet
