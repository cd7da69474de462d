#pragma once
// Search for a user-defined model of the inferred input (torque or field voltage), if no known effect
// explains the records. Candidates are ranked by regression on the inferred input. The leading ones are
// fitted to the records and judged on held-out events, like every hypothesis. Only a model that predicts
// unseen events is offered.
#include <memory>

#include "validate/event/progress.hpp"
#include "validate/hypothesis/judge.hpp"
#include "validate/reduced/free_input.hpp"
#include "validate/user_model_search/candidate.hpp"

namespace swingbank::validate::user_model_search {

/// A user-defined model that was fitted to the records and judged.
struct UserModelFinding {
  UserModelCandidate user_model;              ///< with the fitted values
  std::shared_ptr<const sim::Effect> effect;  ///< compiled form of the model
  hypothesis::Judgement judgement;            ///< of the plant with the model
  std::string words;                          ///< description with fitted values, units and intervals
  std::string toml;                           ///< TOML file for `swingbank add NAME --user-model FILE`
};

/// Result of a search for user-defined models.
struct UserModelSearch {
  fit::InputKind kind = fit::InputKind::none;  ///< input of the search; none: no search
  std::vector<UserModelTrace> traces;          ///< inferred input and signals of each event
  /// Best candidate of each family and signal, in ascending order of score.
  std::vector<UserModelCandidate> ranked;
  /// Models that were fitted to the records: accepted ones first, then in descending order of evidence.
  std::vector<UserModelFinding> findings;
  double seconds = 0;  ///< processing time [s]
  /// Returns the best finding if it was accepted, else null.
  [[nodiscard]] const UserModelFinding* found() const {
    return !findings.empty() && findings.front().judgement.accepted ? &findings.front() : nullptr;
  }
};

/// Result of a diagnosis without an accepted effect.
struct Unexplained {
  const plant::PlantModel& model;                         ///< the given model
  hypothesis::Trial trial;                                ///< events and limits of acceptance
  const fit::Fit& base;                                   ///< fit of the given model
  const std::vector<hypothesis::HeldOut>& held_out_base;  ///< hold-out results of the given model
  const reduced::FreeInput &torque, &field;               ///< inferred inputs
  int threads = 1;                                        ///< number of threads
};

/// Searches for a model of that input, torque or field voltage, whose fit has the lower reduced chi-square.
/// Searches for a model of the other input too if the first search finds no model and the other input
/// explains about as much. Returns an empty result (kind none) if neither input explains most of the
/// residual.
UserModelSearch search_user_models(const Unexplained& case_, const event::Progress& report = {});

/// Returns for example "None of the 31 known effects explains the records. A user-defined model does: ...".
/// Returns an empty text if no model was accepted.
std::string user_model_sentence(const UserModelSearch& search, std::size_t hypotheses);

}  // namespace swingbank::validate::user_model_search
