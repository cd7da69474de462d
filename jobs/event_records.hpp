#pragma once
// What commands that work on several records share: reading them all before anything is said, progress, and
// what is said when it cannot be done.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "base/stop_signal.hpp"
#include "jobs/command_line.hpp"
#include "jobs/course.hpp"
#include "jobs/told_instants.hpp"
#include "validate/check/record_set.hpp"
#include "validate/event/component_model.hpp"
#include "validate/event/point.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"
#include "validate/record/staged.hpp"

namespace swingbank::jobs {

/// --quiet: no progress and no notes on stderr, errors only.
inline bool quiet = false;

/// How a command's records are read, beside what the plant file says.
struct Reading {
  std::vector<std::string> columns;  ///< "V=BUS1.VPM [kV]"
  std::optional<double> from, until;
  std::string component = "plant";    ///< what of the plant is tried
  std::string point;                  ///< file of the point that several units share; empty: the plant's own
  std::vector<std::string> switches;  ///< "event4.csv=2.08"

  /// Adds the options that say what of the files is read, and as what.
  std::vector<Option> add_to(CommandLine& line) {
    return {add_columns(line), add_from(line), add_until(line), add_component(line), add_point(line)};
  }
  Option add_columns(CommandLine& line) {
    return line
        .add(
            "--columns", columns,
            "which columns of the records are read: V=NAME,P=NAME (t, V, theta, f, P, Q, I, phi, speed, Efd, Ifd; of a component "
            "also Vs, Vref, Pm, Pref, gate); "
            "\"V=NAME [kV]\" where the file names no unit, V=#2 for the second column, P=-NAME reverses the sign; "
            "beside [record.columns] of the plant file")
        .comma_separated();
  }
  Option add_from(CommandLine& line) { return line.add("--from", from, "leave out what comes before [s]"); }
  Option add_until(CommandLine& line) { return line.add("--until", until, "leave out what comes later [s]"); }
  /// Adds the point that several units share.
  Option add_point(CommandLine& line) {
    return line.add(
        "--point", point,
        "file of the measured point where several units or a collector stand behind it: the others, whose models "
        "are believed, are taken off the record (configs/plants/README.md)");
  }
  /// Adds the instants of switchings that are known.
  Option add_switch(CommandLine& line) {
    return line
        .add("--switch", switches,
             "instant [s] at which something is switched in the record, or FILE=instant; may be repeated; "
             "default: found by the voltage's jumps and fitted")
        .one_value_a_mention();
  }
  /// Adds what of the plant is tried.
  Option add_component(CommandLine& line) {
    return line
        .add(
            "--component", component,
            "what of the plant is tried: plant, or one part that the record drives with what the others did: "
            "exciter (V, and P, Q, speed, Ifd where its blocks ask for them, Vs and Vref where recorded -> Efd), "
            "governor (speed or f, and Pref -> Pm, gate), "
            "machine (V, angle or f, Efd, and Pm -> P, Q, Ifd, speed)")
        .shows_default()
        .one_of({"plant", "exciter", "governor", "machine"});
  }
  /// The same for another command.
  [[nodiscard]] std::vector<std::string> words() const {
    std::vector<std::string> all;
    for (const auto& column : columns) all.insert(all.end(), {"--columns", column});
    if (from) all.insert(all.end(), {"--from", fmt::format("{}", *from)});
    if (until) all.insert(all.end(), {"--until", fmt::format("{}", *until)});
    if (!point.empty()) all.insert(all.end(), {"--point", point});
    return all;
  }
  /// Puts them into the model; what is done to each of the records before it is checked. Throws InputError.
  validate::check::Preparing apply(validate::plant::PlantModel& model,
                                   const std::vector<std::string>& records) const {
    Problems problems;
    for (const auto& word : columns) {
      const auto equals = word.find('=');
      if (equals == std::string::npos || equals == 0 || equals + 1 == word.size())
        problems.add("'" + word + "'", "--columns", "it says no quantity and column",
                     "write --columns V=NAME,P=NAME");
      else
        model.reading.columns[word.substr(0, equals)] = word.substr(equals + 1);
    }
    if (from && until && !(*from < *until))
      problems.add(fmt::format("--from {:g} with --until {:g}", *from, *until), "--from",
                   "nothing lies between them",
                   "give --from an earlier time than --until, both in s of the record");
    problems.raise();
    if (from) model.reading.from = *from;
    if (until) model.reading.until = *until;
    std::optional<validate::event::MeasuredPoint> at;
    if (!point.empty()) at = validate::event::load_point(point, model);
    using validate::record::Component;
    for (const auto c : {Component::exciter, Component::governor, Component::machine})
      if (component == validate::record::component_name(c)) {
        const std::size_t told = model.warnings.size();
        model = validate::event::component_model(std::move(model), c);
        for (std::size_t k = told; k < model.warnings.size(); ++k)
          fmt::print(stderr, "note: {}\n", model.warnings[k]);
      }
    return [told = told_instants(switches, records), at](validate::record::Record r) {
      if (const auto of = told.find(r.name); of != told.end()) r.switched = of->second;
      return at ? validate::event::of_tried_unit(*at, std::move(r)) : r;
    };
  }
};

/// Says which staged events belong to none of these records: of another test, or its name is mistyped.
inline void tell_events_elsewhere(const std::vector<std::string>& files,
                                  const std::vector<validate::record::StagedEvent>& staged) {
  if (quiet) return;
  for (const auto& e : staged)
    if (std::ranges::none_of(files, [&](const auto& file) { return validate::record::belongs_to(e, file); }))
      fmt::print(stderr,
                 "note: the [[event]] {} of {} is left out (none of the records here has that name)\n",
                 validate::record::staged_name(e.kind), e.record);
}

/// Reads and checks every record, so that all faults of all files are told at once; findings that do not
/// refuse go to stderr.
inline validate::check::RecordSet read_events(const std::vector<std::string>& files,
                                              const validate::plant::PlantModel& model,
                                              const validate::check::Preparing& prepare = {}) {
  Problems problems;
  validate::check::RecordSet set = validate::check::read_records(files, model, problems, prepare);
  std::vector<std::pair<std::string, std::string>> notes;  // each once, with its records
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
  tell_events_elsewhere(files, model.reading.staged);
  problems.raise();
  return set;
}

/// What is known of the records beside their values: when they begin, and what was done to read them.
inline nlohmann::json records_json(const validate::check::RecordSet& set) {
  nlohmann::json all = nlohmann::json::array();
  for (std::size_t k = 0; k < set.records.size(); ++k)
    all.push_back({{"record", set.records[k].name},
                   {"begins", validate::record::beginning(set.records[k])},
                   {"notes", set.warnings[k]}});
  return all;
}

/// Says on stderr what looks wrong in a model and what of it is no plant's own.
inline void tell(const validate::plant::PlantModel& model) {
  if (quiet) return;
  for (const auto& warning : model.warnings) fmt::print(stderr, "note: {}\n", warning);
  if (!model.standard.empty())
    fmt::print(stderr, "note: standard values, not this plant's: {}\n", fmt::join(model.standard, ", "));
}

/// Writes where the course stands over itself where stderr is a terminal, elsewhere as a line every ten
/// seconds; nothing with --quiet.
inline validate::event::Progress progress_line(const Course& course = {}) {
  if (quiet) return {};
  using Clock = std::chrono::steady_clock;
  struct State {  // copies of the function share it
    CourseProgress at;
    Clock::time_point start = Clock::now(), said = start;
  };
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  return [terminal, state = std::make_shared<State>(CourseProgress(course))](
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

inline std::string command_line(const std::string& command, int argc, char** argv) {
  std::string line = "swingbank " + command;
  for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
  return line;
}

/// The problems of an input, one a line; those that differ only in their place share a line.
inline std::string problems_text(const InputError& error) {
  std::vector<Problem> lines;
  for (const Problem& p : error.problems()) {
    const auto same = std::ranges::find_if(
        lines, [&](const Problem& q) { return q.what == p.what && q.why == p.why && q.remedy == p.remedy; });
    if (same == lines.end())
      lines.push_back(p);
    else
      same->where += ", " + p.where;
  }
  std::string text;
  for (const Problem& p : lines) text += p.sentence() + "\n";
  return text;
}

/// Runs it; bad input and failures become a message and exit code 1, a stop before any result exit code 2.
template <class F>
int guarded(const std::string& command, F action) {
  try {
    return action();
  } catch (const Interrupted&) {
    fmt::print(stderr, "swingbank {}: stopped by a signal before there was a result; nothing was written\n",
               command);
    return kSubmitAgain;
  } catch (const InputError& error) {
    fmt::print(stderr, "{}", problems_text(error));
  } catch (const std::exception& error) {
    fmt::print(stderr, "swingbank {}: {}\n", command, error.what());
  }
  return 1;
}

}  // namespace swingbank::jobs
