#pragma once
// Report of a diagnosis as one HTML page, and as JSON with the same figures.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "validate/compare/played.hpp"
#include "validate/diagnose/diagnose.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::diagnose {

/// One measured channel of one event, with the refitted model before and after the addition of the missing
/// effect.
struct ReportChannel {
  std::string name, unit;       ///< name of the channel; its unit
  double scale = 1, noise = 0;  ///< value of 1 pu [unit]; standard deviation of the noise [pu]
  double size = 0;              ///< machine rating for P and Q, otherwise 1 [pu on the record's base]
  std::vector<double> measured, before, after;  ///< [pu]; `after` is empty without an addition
  compare::ErrorMap map_before, map_after;      ///< error maps without and with the addition
  double inside_before = 0, inside_after = 0;   ///< share of samples inside the 99 % band of the noise
};
/// One event of the report.
struct ReportEvent {
  const event::FitEvent* event = nullptr;      ///< event as it was fitted
  std::vector<compare::Window> windows;        ///< evaluation windows
  std::vector<ReportChannel> channels;         ///< measured channels
  double before = 0, after = 0;                ///< RMS of the whitened residual [noise standard deviations]
  double unseen_before = 0, unseen_after = 0;  ///< RMS from a fit without this event; NaN: not tried
};
/// Common content of JSON and page.
struct ReportFigures {
  const fit::Fit* after = nullptr;  ///< fit of the model with the addition; null: no addition
  std::string after_name;           ///< for example "SEXS", "the inferred field voltage"
  std::vector<ReportEvent> events;  ///< one for each event
};
/// Returns the inferred input with the lower reduced chi-square; nullptr if none was inferred.
const reduced::FreeInput* better_input(const Diagnosis& diagnosis);

/// Returns the figures. `after` is the best hypothesis if one was accepted, otherwise the user-defined model
/// that was found, otherwise, if nothing explains the records, the inferred input with the lower chi2. Refers
/// to `diagnosis`, which must outlive the result.
ReportFigures report_figures(const Diagnosis& diagnosis);

/// Returns a fitted parameter as JSON.
nlohmann::json parameter_json(const fit::FittedParameter& p);
/// Returns verdict, evidence, parameters and error maps, without samples.
nlohmann::json diagnosis_json(const plant::PlantModel& model, const Diagnosis& diagnosis,
                              const report::Provenance& provenance);
/// Returns one self-contained page. It contains the JSON (element "figures"), so that programs can read the
/// same figures.
std::string diagnosis_html(const plant::PlantModel& model, const Diagnosis& diagnosis,
                           const report::Provenance& provenance,
                           const std::vector<compare::Played>& played = {});

/// Plays the events into three models: the given one, the one with the accepted addition (if any), and the
/// given one with refitted parameters. The last model decides the exit code.
std::vector<compare::Played> play_models(const plant::PlantModel& model, const Diagnosis& diagnosis,
                                         const thresholds::Acceptance& by,
                                         const compare::CompareOptions& options = {});

/// Returns the command that follows the diagnosis: `calibrate` if the model is adequate, otherwise `add` with
/// the effects that it names. Empty if it names none.
std::string next_command(const Diagnosis& diagnosis, const report::Provenance& provenance);

/// Returns command line, version, model, default parameter values and records.
report::Provenance diagnosis_provenance(const plant::PlantModel& model, const Diagnosis& diagnosis,
                                        const std::string& command_line);

}  // namespace swingbank::validate::diagnose
