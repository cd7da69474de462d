#pragma once
// Results of an interrupted calibrate or add: the parameter values that the fit had reached.
#include <fmt/format.h>

#include <optional>

#include "base/json.hpp"
#include "base/write_file.hpp"
#include "jobs/analysis_options.hpp"
#include "validate/event/event.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::jobs {

constexpr const char* kInterruptedModel = "model-interrupted.toml";

/// Writes the values of an interrupted fit to files named "...interrupted" and keeps the results of earlier
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

/// Runs `work` and returns its exit code. If a signal ends it, writes the best values so far: `fitted`, or
/// the values of the current fit. Rethrows Interrupted if there is no fit yet.
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
