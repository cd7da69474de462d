#pragma once
// Playback of all records into one model (submitted, calibrated, ...) with its verdict on fitness, for output
// and pages.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "validate/compare/fitness.hpp"
#include "validate/compare/measurement.hpp"

namespace swingbank::validate::compare {

/// A model with its comparison to each record.
struct Played {
  std::string name;                     ///< "submitted", "calibrated"
  std::vector<EventComparison> events;  ///< empty if playback of a record failed
  Fitness fitness;                      ///< verdict on fitness for purpose
};

/// Plays the records into the model and judges its fitness. If playback of a record fails, `events` is empty,
/// and `fitness` is not judged and contains the reason.
Played play_and_judge(std::string name, const plant::PlantModel& model,
                      const std::vector<Measurement>& records, CompareOptions options,
                      const thresholds::Acceptance& by);

/// Returns the channel of that name of an event; nullptr if the model is null or the event lacks the channel.
const ChannelComparison* find_channel(const Played* played, std::size_t event, const std::string& name);

/// Returns the events of the first model whose playbacks succeeded; empty if there is no such model.
const std::vector<EventComparison>& followed_events(const std::vector<Played>& played);
/// Returns the records without the measured states speed, Efd and Ifd (--power-only).
std::vector<record::Record> power_only(std::vector<record::Record> records);

/// One line per model, "submitted: Fit for purpose ...", in reverse order: the last model is the result.
std::string fitness_text(const std::vector<Played>& played);
/// JSON object of the verdicts by model name.
nlohmann::json fitness_json(const std::vector<Played>& played);

}  // namespace swingbank::validate::compare
