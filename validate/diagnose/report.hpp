#pragma once
// A diagnosis as one page to hand on, and as JSON with the same figures.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "validate/compare/played.hpp"
#include "validate/diagnose/diagnose.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::diagnose {

/// One measured channel of one event, with the refitted model as it is (before) and with what it lacks
/// (after).
struct ReportChannel {
  std::string name, unit;
  double scale = 1, noise = 0;                  ///< units in 1 pu; standard deviation [pu]
  std::vector<double> measured, before, after;  ///< [pu]; after is empty where nothing was added
  compare::ErrorMap map_before, map_after;
  double inside_before = 0, inside_after = 0;  ///< share of samples within the 99 % band of the noise
};
struct ReportEvent {
  const event::FitEvent* event = nullptr;
  std::vector<compare::Window> windows;
  std::vector<ReportChannel> channels;
  double before = 0, after = 0;                ///< RMS of the whitened residual [noise]
  double unseen_before = 0, unseen_after = 0;  ///< the same, not fitted to this event; NaN: not tried
};
/// What JSON and page are both made of.
struct ReportFigures {
  const fit::Fit* after = nullptr;  ///< null: nothing was added
  std::string after_name;           ///< "SEXS", "the inferred field voltage"
  std::vector<ReportEvent> events;
};
/// `after` is the best hypothesis where one was accepted, else the law that was found, else the inferred
/// input that leaves less. Refers to
/// `diagnosis`, which must outlive it.
ReportFigures report_figures(const Diagnosis& diagnosis);

/// Verdict, evidence, parameters and error maps; no samples (validate/diagnose/README.md).
nlohmann::json diagnosis_json(const plant::PlantModel& model, const Diagnosis& diagnosis,
                              const report::Provenance& provenance);
/// One self-contained page. The JSON is part of it (element "figures"), so that a program can read what a
/// person reads.
std::string diagnosis_html(const plant::PlantModel& model, const Diagnosis& diagnosis,
                           const report::Provenance& provenance,
                           const std::vector<compare::Played>& played = {});

/// The events of the model as it is, with what it lacks where an effect or a law was accepted, and with its
/// parameters refitted: the last counts.
std::vector<compare::Played> play_models(const plant::PlantModel& model, const Diagnosis& diagnosis,
                                         const thresholds::Acceptance& by,
                                         const compare::CompareOptions& options = {});

/// Hashes of model and records, version and command line.
report::Provenance diagnosis_provenance(const plant::PlantModel& model, const Diagnosis& diagnosis,
                                        const std::string& command_line);

}  // namespace swingbank::validate::diagnose
