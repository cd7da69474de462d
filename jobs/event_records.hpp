#pragma once
// Shared code of commands that process several records: options for reading, checks of all records together,
// and progress.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "base/shell_word.hpp"
#include "base/stop_signal.hpp"
#include "jobs/command_line.hpp"
#include "jobs/progress_plan.hpp"
#include "validate/check/record_set.hpp"
#include "validate/event/component_model.hpp"
#include "validate/event/point.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"
#include "validate/switching/given.hpp"

namespace swingbank::jobs {

/// Value of --quiet: standard error shows only errors, neither progress nor notes.
inline bool quiet = false;

/// Options for reading the records of a command, in addition to the plant file's settings.
struct Reading {
  std::vector<std::string> columns;  ///< "V=BUS1.VPM [kV]"
  std::optional<double> from, until;
  std::string component = "plant";    ///< part of the plant under test
  std::string point;                  ///< file of the measuring point that several units share; empty: none
  std::vector<std::string> switches;  ///< switching times given by the user, "event4.csv=2.08"

  /// Adds the options for columns, time range, component and measuring point.
  std::vector<Option> add_to(CommandLine& line) {
    return {add_columns(line), add_from(line), add_until(line), add_component(line), add_point(line)};
  }
  Option add_columns(CommandLine& line) {
    return line
        .add(
            "--columns", columns,
            "columns of the records: V=NAME,P=NAME (t, V, theta, f, P, Q, I, phi, speed, Efd, Ifd; of a component "
            "also Vs, Vref, Pm, Pref, gate); "
            "\"V=NAME [kV]\" where the file names no unit, V=#2 for the second column, P=-NAME reverses the sign; "
            "in addition to [record.columns] of the plant file")
        .comma_separated();
  }
  Option add_from(CommandLine& line) {
    return line.add("--from", from, "exclude samples before this time [s]");
  }
  Option add_until(CommandLine& line) {
    return line.add("--until", until, "exclude samples after this time [s]");
  }
  /// Adds --point, the measuring point that several units share.
  Option add_point(CommandLine& line) {
    return line.add(
        "--point", point,
        "file that describes the measuring point, if it serves several units or a collector system: the "
        "simulated power of the other units is subtracted from the record "
        "(configs/plants/README.md)");
  }
  /// Adds --switch, the switching times given by the user.
  Option add_switch(CommandLine& line) {
    return line
        .add("--switch", switches,
             "switching time [s] in the record, or FILE=TIME; may be repeated; default: estimated "
             "from voltage steps and fitted")
        .one_value_a_mention();
  }
  /// Adds --component, the part of the plant under test.
  Option add_component(CommandLine& line) {
    return line
        .add("--component", component,
             "part of the plant under test: plant, or one component with the recorded signals as its "
             "inputs: exciter (V, and P, Q, speed, Ifd if its model uses them, Vs and Vref "
             "if recorded -> Efd), governor (speed or f, and Pref -> Pm, gate), machine (V, angle "
             "or f, Efd, and Pm -> P, Q, Ifd, speed)")
        .shows_default()
        .one_of({"plant", "exciter", "governor", "machine"});
  }
  /// Returns the columns, the time range and the measuring point as arguments for another command.
  [[nodiscard]] std::vector<std::string> words() const {
    std::vector<std::string> all;
    for (const auto& column : columns) all.insert(all.end(), {"--columns", column});
    if (from) all.insert(all.end(), {"--from", fmt::format("{}", *from)});
    if (until) all.insert(all.end(), {"--until", fmt::format("{}", *until)});
    if (!point.empty()) all.insert(all.end(), {"--point", point});
    return all;
  }
  /// Applies the options to the model. Returns a function that prepares each record before its checks. The
  /// function sets the switching times, and subtracts the power of the other units at a shared measuring
  /// point. Throws InputError if an option is invalid.
  validate::check::Preparing apply(validate::plant::PlantModel& model,
                                   const std::vector<std::string>& records) const {
    Problems problems;
    for (const auto& word : columns) {
      const auto equals = word.find('=');
      if (equals == std::string::npos || equals == 0 || equals + 1 == word.size())
        problems.add("'" + word + "'", "--columns", "quantity or column is missing",
                     "write --columns V=NAME,P=NAME");
      else
        model.reading.columns[word.substr(0, equals)] = word.substr(equals + 1);
    }
    if (from && until && !(*from < *until))
      problems.add(fmt::format("--from {:g} with --until {:g}", *from, *until), "--from",
                   "--from is not before --until",
                   "give --from an earlier time than --until, both in s of the record");
    problems.raise();
    if (from) model.reading.from = *from;
    if (until) model.reading.until = *until;
    std::optional<validate::event::MeasuredPoint> at;
    if (!point.empty()) at = validate::event::load_point(point, model);
    using validate::record::Component;
    for (const auto c : {Component::exciter, Component::governor, Component::machine})
      if (component == validate::record::component_name(c)) {
        const std::size_t warnings_before = model.warnings.size();
        model = validate::event::component_model(std::move(model), c);
        for (std::size_t k = warnings_before; k < model.warnings.size(); ++k)
          fmt::print(stderr, "note: {}\n", model.warnings[k]);
      }
    return [given_times = validate::switching::given_switching_times(switches, records),
            at](validate::record::Record r) {
      if (const auto of = given_times.find(r.name); of != given_times.end()) r.switched = of->second;
      return at ? validate::event::of_tried_unit(*at, std::move(r)) : r;
    };
  }
};

/// Prints a note for each staged event that applies to none of these records, because it belongs to another
/// test or its record's name is misspelled.
inline void note_unused_events(const std::vector<std::string>& files,
                               const std::vector<validate::record::StagedEvent>& staged) {
  if (quiet) return;
  for (const auto& e : staged)
    if (std::ranges::none_of(files, [&](const auto& file) { return e.applies_to(file); }))
      fmt::print(stderr, "note: the [[event]] {} of {} is not used (none of these records has that name)\n",
                 validate::record::staged_name(e.kind), e.record);
}

/// Reads and checks all records. Throws InputError with the problems of all files together. Prints warnings
/// to standard error.
inline validate::check::RecordSet read_events(const std::vector<std::string>& files,
                                              const validate::plant::PlantModel& model,
                                              const validate::check::Preparing& prepare = {}) {
  Problems problems;
  validate::check::RecordSet set = validate::check::read_records(files, model, problems, prepare);
  std::vector<std::pair<std::string, std::string>> notes;  // warning and the records that it concerns
  for (std::size_t k = 0; k < set.records.size(); ++k)
    for (const auto& warning : set.warnings[k]) {
      const auto known = std::ranges::find(notes, warning, &std::pair<std::string, std::string>::first);
      if (known == notes.end())
        notes.emplace_back(warning, set.records[k].name);
      else
        known->second += ", " + set.records[k].name;
    }
  for (const auto& [warning, of] : notes)
    if (!quiet) fmt::print(stderr, "note on {}: {}\n", of, warning);
  note_unused_events(files, model.reading.staged);
  problems.raise();
  return set;
}

/// Returns the records' metadata: name, time of the first sample, and notes from reading them.
inline nlohmann::json records_json(const validate::check::RecordSet& set) {
  nlohmann::json all = nlohmann::json::array();
  for (std::size_t k = 0; k < set.records.size(); ++k)
    all.push_back({{"record", set.records[k].name},
                   {"begins", validate::record::beginning(set.records[k])},
                   {"notes", set.warnings[k]}});
  return all;
}

/// Prints a model's warnings, and its parameters with default values, to standard error.
inline void print_warnings(const validate::plant::PlantModel& model) {
  if (quiet) return;
  for (const auto& warning : model.warnings) fmt::print(stderr, "note: {}\n", warning);
  if (!model.defaults.empty())
    fmt::print(stderr, "note: default values, not this plant's: {}\n", fmt::join(model.defaults, ", "));
}

/// Returns a progress callback. On a terminal it updates one line of standard error; otherwise it prints a
/// line every ten seconds. With --quiet, returns an empty function.
inline validate::event::Progress progress_line(const ProgressPlan& plan = {}) {
  if (quiet) return {};
  using Clock = std::chrono::steady_clock;
  struct State {  // shared by copies of the function
    PlannedProgress at;
    Clock::time_point start = Clock::now(), said = start;
  };
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  return [terminal, state = std::make_shared<State>(PlannedProgress(plan))](
             Phase phase, const std::string& item, int done, int total) {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - state->start).count();
    const std::string line = state->at.line(phase, item, done, total, seconds);
    if (terminal) {
      fmt::print(stderr, "\r\033[K{}{}", line, done == total ? "\r\033[K" : "");
    } else if (now - state->said >= std::chrono::seconds(10)) {
      state->said = now;
      fmt::print(stderr, "after {}: {}\n", duration_text(seconds), line);
    }
    std::fflush(stderr);
  };
}

/// Returns the command line "swingbank <command> <arguments>", quoted for a shell, for the provenance of
/// results.
inline std::string command_line(const std::string& command, int argc, char** argv) {
  std::string line = "swingbank " + command;
  for (int i = 1; i < argc; ++i) line += " " + shell_word(argv[i]);
  return line;
}

}  // namespace swingbank::jobs
