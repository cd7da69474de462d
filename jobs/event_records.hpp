#pragma once
// What commands that work on several records share: reading them all before anything is said, progress, and
// what is said when it cannot be done.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "validate/check/record_set.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"

namespace swingbank::jobs {

/// Reads and checks every record, so that all faults of all files are told at once; findings that do not
/// refuse go to stderr.
inline std::vector<validate::record::Record> read_events(const std::vector<std::string>& files,
                                                         const validate::plant::PlantModel& model) {
  Problems problems;
  validate::check::RecordSet set = validate::check::read_records(files, model, problems);
  for (const auto& warnings : set.warnings)
    for (const auto& warning : warnings) fmt::print(stderr, "note: {}\n", warning);
  problems.raise();
  return std::move(set.records);
}

/// Says on stderr what looks wrong in a model and what of it is no plant's own.
inline void tell(const validate::plant::PlantModel& model) {
  for (const auto& warning : model.warnings) fmt::print(stderr, "note: {}\n", warning);
  if (!model.standard.empty())
    fmt::print(stderr, "note: standard values, not this plant's: {}\n", fmt::join(model.standard, ", "));
}

/// The model that a fit begins with: of a calibration that did not hold, the one before it.
inline validate::plant::PlantModel load_model_to_fit(const std::string& file) {
  validate::plant::PlantModel model = validate::plant::load_plant_model(file);
  tell(model);
  if (model.submitted) fmt::print(stderr, "note: begun with the values before that calibration\n");
  return validate::plant::as_submitted(std::move(model));
}

/// Writes "what: done of total" over itself where stderr is a terminal, elsewhere as a line every ten
/// seconds.
inline std::function<void(const std::string&, int, int)> progress_line() {
  if (::isatty(STDERR_FILENO) != 0)
    return [](const std::string& what, int done, int total) {
      fmt::print(stderr, "\r\033[K{}: {} of {}{}", what, done, total, done == total ? "\r\033[K" : "");
      std::fflush(stderr);
    };
  using Clock = std::chrono::steady_clock;
  return [start = Clock::now(), said = Clock::now()](const std::string& what, int done, int total) mutable {
    const auto now = Clock::now();
    if (now - said < std::chrono::seconds(10)) return;
    said = now;
    fmt::print(stderr, "after {:.0f} s: {}: {} of {}\n", std::chrono::duration<double>(now - start).count(),
               what, done, total);
    std::fflush(stderr);
  };
}

inline std::string command_line(const std::string& command, int argc, char** argv) {
  std::string line = "swingbank " + command;
  for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
  return line;
}

/// Runs it; bad input and failures become a message and exit code 1.
template <class F>
int guarded(const std::string& command, F action) {
  try {
    return action();
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
  } catch (const std::exception& error) {
    fmt::print(stderr, "swingbank {}: {}\n", command, error.what());
  }
  return 1;
}

}  // namespace swingbank::jobs
