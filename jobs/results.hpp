#pragma once
// What compare, calibrate, diagnose and add share about their results: the folder, and what is written where
// a signal has stopped the work.
#include <fmt/format.h>

#include "base/json.hpp"
#include "base/output_folder.hpp"
#include "base/write_file.hpp"
#include "validate/event/event.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::jobs {

constexpr const char* kInterruptedModel = "model-interrupted.toml";

/// Writes the values that an interrupted fit had reached, under names that say so, and keeps the results of
/// earlier runs. Returns the exit code.
inline int write_interrupted(OutputFolder& folder, const std::string& command,
                             const std::string& command_line, const validate::plant::PlantModel& before,
                             validate::plant::PlantModel model, const validate::fit::Fit& reached) {
  catch_stop_signals();
  const std::string sentence = fmt::format(
      "Interrupted: the best values until then, with chi2 per value {:.4g}. The fit has not ended and is not "
      "judged.",
      reached.misfit());
  model.plant = reached.plant;
  model = validate::event::whole_model(std::move(model));
  if (command == "calibrate") model.submitted = validate::event::whole_model(before).plant;
  validate::plant::write_plant_file(
      folder.file(kInterruptedModel), model,
      {"INTERRUPTED: the fit that gave these values has not ended. Do not use them.",
       "Command: " + command_line});
  nlohmann::json result = {{"format", "swingbank-interrupted-1"},
                           {"interrupted", true},
                           {"command", command_line},
                           {"sentence", sentence},
                           {"chi2_per_value", reached.misfit()},
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

}  // namespace swingbank::jobs
