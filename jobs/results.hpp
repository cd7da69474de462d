#pragma once
// Results of calibrate and add: page, JSON and, after an interruption, the parameter values reached by the
// fit.
#include <fmt/format.h>

#include <optional>

#include "base/json.hpp"
#include "base/write_file.hpp"
#include "jobs/analysis_options.hpp"
#include "validate/compare/report_json.hpp"
#include "validate/event/event.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::jobs {

constexpr const char *kInterruptedModel = "model-interrupted.toml", *kPage = "report.html";

/// Plays the events with the submitted model and with `after`; `name`: name of `after` in the results.
inline std::vector<validate::compare::Played> play_both(const AnalysisOptions& of,
                                                        const validate::plant::PlantModel& before,
                                                        const std::string& name,
                                                        const validate::plant::PlantModel& after,
                                                        const std::vector<validate::record::Record>& records,
                                                        const validate::event::Progress& progress) {
  interruption_point();
  validate::compare::CompareOptions options = of.comparing();
  options.progress = progress;
  const auto shown = validate::compare::measurements(of.compared(records), options, before.plant.mva);
  return {validate::compare::play_and_judge("submitted", before, shown, options, of.judging.by),
          validate::compare::play_and_judge(name, after, shown, options, of.judging.by)};
}

/// Adds the entries common to all commands to `result`, and writes the page and COMMAND.json; the page also
/// contains the JSON. `page` must already have title, events and verdict. Returns the terminal text on the
/// model `after`.
inline std::string write_results(const AnalysisOptions& of, const std::string& command,
                                 const std::string& command_line, const validate::plant::PlantModel& before,
                                 const validate::plant::PlantModel& after,
                                 validate::compare::CommandPage page, nlohmann::json& result) {
  using namespace validate;
  result["fitness"] = compare::fitness_json(page.played);
  page.handed_in = compare::handed_in(after, compare::followed_events(page.played));
  page.provenance = {{"command", command_line},
                     {"software", fmt::format("swingbank {}", version())},
                     {"model", before.origin}};
  for (const auto& e : page.played.front().events)
    if (const auto begins = record::beginning(e.record); !begins.empty())
      page.provenance.emplace_back("begins", e.record.name + ": t = 0 is " + begins);
  sign(page.provenance, of.judging, of.model, of.records);
  page.signatures = true;
  compare::add_report(result, command, page);
  page.figures = json_text(result);
  write_file(of.results().file(kPage), compare::command_html(page));
  write_file(of.results().file(command + ".json"), json_text(result, 1) + "\n");
  return compare::handed_in_text(*page.handed_in);
}

/// Ends a command whose results are written: prints `result` (--json) or `text`, and prints the page to the
/// file of --pdf.
inline void finish_results(const AnalysisOptions& of, const nlohmann::json& result, const std::string& text) {
  of.results().finish();
  fmt::print("{}\n", of.json ? json_text(result, 1) : text);
  of.judging.print(of.results().path() / kPage);
}

/// Writes the values of an interrupted fit to files named "...interrupted". Keeps the results of earlier
/// runs. Returns the exit code.
inline int write_interrupted(const AnalysisOptions& of, const std::string& command,
                             const std::string& command_line, const validate::plant::PlantModel& before,
                             const validate::fit::Fit& reached) {
  OutputFolder& folder = of.results();
  const std::string sentence = fmt::format(
      "Interrupted before a verdict: best values so far, reduced chi-square {:.4g}.", reached.reduced_chi2());
  validate::plant::PlantModel model = before;
  model.plant = reached.plant;
  of.keep_user_models(model);
  model = validate::event::whole_model(std::move(model));
  if (command == "calibrate") model.submitted = validate::event::whole_model(before).plant;
  validate::plant::write_plant_file(
      folder.file(kInterruptedModel), model,
      {"INTERRUPTED: the fit of these values is incomplete. Do not use them.", "Command: " + command_line});
  nlohmann::json result = {{"format", "swingbank-interrupted-1"},
                           {"interrupted", true},
                           {"command", command_line},
                           {"sentence", sentence},
                           {"chi2_per_value", reached.reduced_chi2()},
                           {"parameters", nlohmann::json::array()}};
  for (const auto& p : reached.parameters)
    result["parameters"].push_back(
        {{"name", p.full_name()}, {"unit", p.unit}, {"model", p.start}, {"reached", p.value}});
  const auto file = folder.file(command + "-interrupted.json");
  write_file(file, json_text(result, 1) + "\n");
  folder.finish(OutputFolder::Earlier::stay);
  fmt::print("{}\nmodel: {}\nvalues: {}\n", sentence, (folder.path() / kInterruptedModel).string(),
             file.string());
  return kSubmitAgain;
}

/// Runs `work` and returns its exit code. If a signal ends the work, writes the best values so far: those of
/// `fitted`, else those of the current fit. Rethrows Interrupted if there is no fit yet.
template <class Work>
int keep_reached(const AnalysisOptions& of, const std::string& command, const std::string& command_line,
                 const validate::plant::PlantModel& model, std::optional<validate::fit::Fit>& fitted,
                 Work work) {
  try {
    return work();
  } catch (const validate::fit::InterruptedFit& ended) {
    if (!fitted) fitted = ended.reached;
  } catch (const Interrupted&) {
    if (!fitted) throw;
  }
  return write_interrupted(of, command, command_line, model, *fitted);
}

}  // namespace swingbank::jobs
