#pragma once
// Options with the same meaning in compare, calibrate, diagnose, add and serve.
#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/output_folder.hpp"
#include "base/shell_word.hpp"
#include "base/stop_signal.hpp"
#include "jobs/command_line.hpp"
#include "jobs/event_records.hpp"
#include "jobs/verdict.hpp"
#include "sim/user_models/user_model.hpp"
#include "validate/compare/played.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::jobs {

/// Values of the shared options.
struct AnalysisOptions {
  explicit AnalysisOptions(std::string folder) : out(std::move(folder)) {}
  std::string model, out;
  std::vector<std::string> records, user_model_files, held_out;
  bool json = false, verbose = false, measured_states = true;
  int threads = -1;  ///< 0: one per core; -1: option absent
  double step_threshold = validate::switching::kStepThreshold;
  double pre_event = validate::event::FitEventOptions{}.pre_event;  ///< length of the steady-state window [s]
  double prior_sd = validate::thresholds::parameters.prior_sd;      ///< prior standard deviation, relative
  Reading reading;
  Judging judging;
  std::vector<std::pair<std::string, const sim::Effect*>> user_models;  ///< file and user-defined model

  /// Declares the options. `files`: names of the files in --out, for the help. Returns the options that
  /// concern a single plant; they are invalid if the command processes a grid or a fleet.
  std::vector<Option> declare(CommandLine& line, const std::string& files) {
    std::vector<Option> of_one_plant;
    const auto keep = [&](const Option& option) { of_one_plant.push_back(option); };
    line.group("Input");
    const Option plant =
        line.add("--model", model, "plant file, with [[event]] for staged tests (configs/plants/README.md)");
    const Option events =
        line.add("--records,--record", records,
                 "records of the events (CSV, COMTRADE or HDF5; validate/record/README.md)");
    plant.needs(events);
    events.needs(plant);
    keep(plant);
    for (const Option& option : reading.add_to(line)) keep(option);
    keep(line.add_flag_off("--power-only", measured_states,
                           "ignore recorded speed, Efd and Ifd: compare P and Q only"));
    keep(line.add("--user-model", user_model_files,
                  "file (.toml) of a user-defined model that the plant may use and that may be added to it; "
                  "may be repeated")
             .one_value_a_mention());
    line.group("Events");
    keep(reading.add_switch(line));
    keep(line.add("--step-threshold", step_threshold,
                  "voltage step of a switching [pu]; a fit also uses steps of half this size")
             .shows_default()
             .positive());
    keep(line.add("--pre-event", pre_event,
                  "length of the steady-state window at the start of records without switching [s]")
             .shows_default()
             .positive());
    line.group("Output");
    line.add("--out", out, "folder for " + files).shows_default();
    keep(judging.add_to(line));
    line.add_flag("--json", json, "print the result as JSON instead of text");
    line.add_flag("--verbose", verbose, "print all tables and every note on the terminal");
    line.group("Expert");
    line.add("--threads", threads, "processor cores to use; 0: all (default)").between(0, 4096);
    return of_one_plant;
  }
  /// Declares the options of commands that fit parameters.
  std::vector<Option> declare_fit(CommandLine& line) {
    line.group("Expert");
    return {line.add("--prior-sd", prior_sd, "prior standard deviation of the model's parameters, relative")
                .shows_default()
                .between(0.001, 2.0)};
  }
  /// Declares --hold-out: the events that are excluded from the fit and used to judge it.
  void declare_hold_out(CommandLine& line) {
    line.group("Events");
    line.add("--hold-out", held_out,
             "record (name or number from 1) excluded from the fit, to judge it; may be repeated");
  }

  /// Returns the options with which another command reads the same records: " --records fault1.csv
  /// --power-only".
  [[nodiscard]] std::string inputs() const {
    std::vector<std::string> words = {"--records"};
    words.insert(words.end(), records.begin(), records.end());
    for (const auto& word : reading.words()) words.push_back(word);
    for (const auto& word : reading.switches) words.insert(words.end(), {"--switch", word});
    for (const auto& file : user_model_files) words.insert(words.end(), {"--user-model", file});
    if (reading.component != "plant") words.insert(words.end(), {"--component", reading.component});
    if (!measured_states) words.emplace_back("--power-only");
    const validate::event::FitEventOptions usual;
    if (step_threshold != usual.step_threshold)
      words.insert(words.end(), {"--step-threshold", fmt::format("{}", step_threshold)});
    if (pre_event != usual.pre_event)
      words.insert(words.end(), {"--pre-event", fmt::format("{}", pre_event)});
    if (!judging.accept.empty()) words.insert(words.end(), {"--accept", judging.accept});
    std::string text;
    for (const auto& word : words) text += " " + shell_word(word);
    return text;
  }

  /// Locks the output folder; call it after all inputs are read and before the work. `names`: files that the
  /// command may write into it. Throws InputError if one of them is an input.
  void open_results(const std::string& command, const std::vector<std::string>& names) {
    interruption_point();
    folder_ = std::make_shared<OutputFolder>(out, command, names, judging.outputs());
  }
  /// Returns the folder for writing the results. From this call on, a stop signal no longer ends the command.
  [[nodiscard]] OutputFolder& results() const {
    catch_stop_signals();
    return *folder_;
  }

  /// Limits the number of threads of this process to --threads.
  void limit_threads() const {
    if (threads > 0) omp_set_num_threads(threads);
  }
  /// Returns the plant model, with the user-defined models of --user-model in its library. With `to_fit`, the
  /// result of an inadequate calibration is reset to the values before it. Throws InputError if a file is
  /// invalid.
  validate::plant::PlantModel load_model(bool to_fit) {
    using namespace validate;
    plant::PlantModel loaded;
    try {
      loaded = plant::load_plant_model(
          model, std::vector<std::filesystem::path>(user_model_files.begin(), user_model_files.end()));
    } catch (const InputError& error) {
      Problems problems;  // with those of the records, as far as they show without the model's base
      problems.add(error);
      for (const auto& named : records) record::check_files(record::Source(named), problems);
      problems.raise();
    }
    for (const auto& file : user_model_files)
      user_models.emplace_back(
          file, &sim::user_models::load_user_model(std::filesystem::path(file), loaded.library));
    keep_user_models(loaded);
    print_warnings(loaded);
    if (!to_fit) return loaded;
    if (loaded.submitted && !quiet)
      fmt::print(stderr, "note: started from the values before that calibration\n");
    return plant::as_submitted(std::move(loaded));
  }
  /// Adds to the model the names of the --user-model files that define its user-defined models.
  void keep_user_models(validate::plant::PlantModel& of) const {
    for (const auto& [file, effect] : user_models)
      for (const auto& block : of.plant.controls)
        if (block.effect == effect && std::ranges::count(of.user_models, std::filesystem::path(file)) == 0)
          of.user_models.emplace_back(file);
  }
  [[nodiscard]] validate::event::FitEventOptions events() const {
    validate::event::FitEventOptions options;
    options.measured_states = measured_states;
    options.step_threshold = step_threshold;
    options.pre_event = pre_event;
    return options;
  }
  [[nodiscard]] validate::compare::CompareOptions comparing() const {
    validate::compare::CompareOptions options;
    options.step_threshold = step_threshold;
    options.play_in.pre_event = pre_event;
    return options;
  }
  /// Returns the records without the channels that --power-only ignores.
  [[nodiscard]] std::vector<validate::record::Record> compared(
      std::vector<validate::record::Record> all) const {
    return measured_states ? std::move(all) : validate::compare::power_only(std::move(all));
  }

 private:
  std::shared_ptr<OutputFolder> folder_;
};

}  // namespace swingbank::jobs
