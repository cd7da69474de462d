#pragma once
// Row of a fleet's table: the result of one plant, also as JSON.
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace swingbank::validate::fleet {

/// Format of plant.json; part of the hash of a plant's inputs, so that results of an older format are
/// computed again.
inline constexpr const char* kPlantFormat = "swingbank-fleet-plant-4";

/// Largest error of P and Q of the submitted model, and its verdict on fitness for purpose.
struct SubmittedError {
  double percent = 0;                  ///< absolute value [% of the machine's MVA]; NaN: not judged
  std::string channel, window, event;  ///< where the error occurs; empty: not judged
  std::string fit = "not judged";      ///< fit for purpose: "yes", "no" or "not judged"
};

/// Row of the fleet's table.
struct FleetRow {
  std::string plant;
  std::string verdict;                          ///< diagnose::verdict_name(), or "failed"
  std::vector<std::string> effects;             ///< see Diagnosis::effects
  std::vector<std::string> equivalent;          ///< see Diagnosis::equivalent
  std::map<std::string, double> probabilities;  ///< of the explanations in the credible set
  std::string side;
  SubmittedError error;
  double evidence = 0;  ///< 2 ln(Bayes factor) of the leading accepted hypothesis; NaN: no effect was named
  double left = 0;      ///< normalised RMS of the residual of the refitted model, before an effect is added
  double unseen_before = 0, unseen_after = 0;  ///< normalised RMS on held-out events without and with the
                                               ///< leading hypothesis; NaN: not judged
  double chance =
      0;  ///< upper bound of the probability that noise alone gives this gain; NaN: no effect was named
  int events = 0;
  std::string sentence;  ///< verdict, or the problems, one per line
  std::string inputs;    ///< hash of all inputs of the row
  [[nodiscard]] bool failed() const { return verdict == "failed"; }
  /// Returns whether the refitted model is adequate and the submitted one is not unfit for purpose. A model
  /// that is adequate only with refitted parameters, and not fit for purpose as submitted, has wrong
  /// parameters.
  [[nodiscard]] bool adequate() const { return verdict == "adequate" && error.fit != "no"; }
};
/// Returns the row of a plant that could not be diagnosed, with the reason `why`.
FleetRow failed_row(const std::string& plant, const std::string& why);
nlohmann::json row_json(const FleetRow& row);
/// Reads a row. Throws InputError, naming the file `where`, if the text is not a row.
FleetRow read_row(const std::string& text, const std::string& where);

}  // namespace swingbank::validate::fleet
