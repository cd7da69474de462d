#include "validate/fleet/row.hpp"

#include <stdexcept>

#include "base/constants.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"

namespace swingbank::validate::fleet {

using nlohmann::json;

namespace {

double number_of(const json& j, const char* key) {
  return j.at(key).is_null() ? constants::nan : j.at(key).get<double>();
}

json error_json(const SubmittedError& e) {
  return {{"percent_of_mva", e.percent},
          {"channel", e.channel},
          {"window", e.window},
          {"event", e.event},
          {"fit_for_purpose", e.fit}};
}
SubmittedError read_error(const json& j) {
  return {number_of(j, "percent_of_mva"), j.at("channel"), j.at("window"), j.at("event"),
          j.at("fit_for_purpose")};
}

}  // namespace

FleetRow failed_row(const std::string& plant, const std::string& why) {
  FleetRow row;
  row.plant = plant;
  row.verdict = "failed";
  row.side = "none";
  row.error.percent = row.evidence = row.left = row.unseen_before = row.unseen_after = row.chance =
      constants::nan;
  row.sentence = why;
  return row;
}

json row_json(const FleetRow& r) {
  return {{"format", kPlantFormat},
          {"plant", r.plant},
          {"verdict", r.verdict},
          {"effects", r.effects},
          {"equivalent", r.equivalent},
          {"probabilities", r.probabilities},
          {"side", r.side},
          {"submitted", error_json(r.error)},
          {"evidence", r.evidence},
          {"normalised_rms_refitted", r.left},
          {"unseen_normalised_rms_before", r.unseen_before},
          {"unseen_normalised_rms_after", r.unseen_after},
          {"probability_by_noise_alone_at_most", r.chance},
          {"events", r.events},
          {"sentence", r.sentence},
          {"inputs_sha256", r.inputs}};
}

FleetRow read_row(const std::string& text, const std::string& where) {
  try {
    const json j = json::parse(text);
    if (j.at("format") != kPlantFormat)
      throw std::invalid_argument("its format is not " + std::string(kPlantFormat));
    return {j.at("plant"),
            j.at("verdict"),
            j.at("effects"),
            j.at("equivalent"),
            j.at("probabilities"),
            j.at("side"),
            read_error(j.at("submitted")),
            number_of(j, "evidence"),
            number_of(j, "normalised_rms_refitted"),
            number_of(j, "unseen_normalised_rms_before"),
            number_of(j, "unseen_normalised_rms_after"),
            number_of(j, "probability_by_noise_alone_at_most"),
            j.at("events"),
            j.at("sentence"),
            j.at("inputs_sha256")};
  } catch (const std::exception& error) {
    throw InputError(
        {"not a result file of a plant", where, error.what(), "remove its folder and run the command again"});
  }
}

}  // namespace swingbank::validate::fleet
