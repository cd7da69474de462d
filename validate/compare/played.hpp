#pragma once
// A plant's events played into one of its models (as submitted, as a command leaves it), and the verdict on
// its fitness: what commands print, and what their pages draw.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "validate/compare/fitness.hpp"

namespace swingbank::validate::compare {

struct Played {
  std::string name;                     ///< "submitted", "calibrated"
  std::vector<EventComparison> events;  ///< empty where the model cannot follow them
  Fitness fitness;
};

/// Plays the records into the model and judges it. A model that cannot follow them is not judged, and says
/// why.
Played play_and_judge(std::string name, const plant::PlantModel& model,
                      const std::vector<record::Record>& records, CompareOptions options,
                      const thresholds::Acceptance& by);

/// The records without what only measured states can be compared with (--power-only).
std::vector<record::Record> power_only(std::vector<record::Record> records);

/// "submitted: Fit for purpose ...", a line each; the last of them counts and comes first.
std::string fitness_text(const std::vector<Played>& played);
/// By name.
nlohmann::json fitness_json(const std::vector<Played>& played);

}  // namespace swingbank::validate::compare
