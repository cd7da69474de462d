#pragma once
// What the commands that judge a model share: the limits by which it is fit for its purpose, its events
// played as it was submitted and as the command leaves it, and the exit code that tells both verdicts.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "jobs/command_line.hpp"
#include "validate/compare/fitness.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::jobs {

/// By which limits a model is judged fit for its purpose.
struct Judging {
  std::string accept;
  validate::thresholds::Acceptance by;

  Option add_to(CommandLine& line) {
    return line.add(
        "--accept", accept,
        fmt::format("limits by which the model is fit for purpose: a file (configs/accept/README.md), or "
                    "the preset {} (default: {})",
                    fmt::join(validate::thresholds::acceptance_presets(), " or "),
                    validate::thresholds::acceptance_presets().front()));
  }
  /// Before the work. Throws InputError.
  void read() { by = validate::thresholds::read_acceptance(accept); }
};

/// The records without what only measured states can be compared with (--power-only).
inline std::vector<validate::record::Record> power_only(std::vector<validate::record::Record> records) {
  for (auto& r : records) r.speed = r.Efd = r.Ifd = {};
  return records;
}

/// A model that a command was given or makes, and its events.
struct Played {
  std::string name;  ///< "submitted", "calibrated"
  std::vector<validate::compare::EventComparison> events;
  validate::compare::Fitness fitness;
};

/// Plays the records into the model and judges it. A model that cannot follow them is not judged, and says
/// why.
inline Played play_and_judge(std::string name, const validate::plant::PlantModel& model,
                             const std::vector<validate::record::Record>& records,
                             validate::compare::CompareOptions options, const Judging& judging) {
  namespace compare = validate::compare;
  Played played{std::move(name), {}, {}};
  const double mva = model.plant.mva;
  try {
    options.jumps = validate::event::jumps_of(records, options.jump_threshold);
    for (const auto& record : records)
      played.events.push_back(compare::compare_event(model, record, options));
    compare::judge(played.events);  // the bounds of the maps
    played.fitness = compare::judge_fitness(played.events, mva, judging.by);
  } catch (const InputError& error) {
    played.events.clear();
    played.fitness = compare::not_judged(judging.by, mva, error.problems().front().sentence());
  }
  return played;
}

/// "Fit for purpose ..." of each, a line each; the last is the one that counts and comes first.
inline std::string fitness_text(const std::vector<Played>& played) {
  std::string text;
  for (auto p = played.rbegin(); p != played.rend(); ++p)
    text += fmt::format("{}: {}\n", p->name, p->fitness.sentence);
  return text;
}

inline nlohmann::json fitness_json(const std::vector<Played>& played) {
  nlohmann::json all = nlohmann::json::object();
  for (const Played& p : played) all[p.name] = validate::compare::fitness_json(p.fitness);
  return all;
}

}  // namespace swingbank::jobs
