#pragma once
// Sparse selection of the parameters that must change, as terminal text and JSON.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "validate/calibrate/calibrate.hpp"
#include "validate/fit/sparse_selection.hpp"

namespace swingbank::validate::calibrate {

/// Smallest set of parameters that must change for the model to explain the events.
struct WrongParameters {
  fit::SparseSelection found;  ///< selected parameters with their fit
  plant::PlantModel model;     ///< with these parameters changed and all others unchanged
  double adequate = 0;         ///< limit of the reduced chi-square for noise alone
  std::string sentence;        ///< result in words
  /// Whether the residual is noise with these parameters changed.
  [[nodiscard]] bool is_adequate() const { return found.fit.reduced_chi2() <= adequate; }
};

/// Selects the parameters that must change. Held-out records are not used. The other options used are
/// `prior_sd`, `fixed`, `events`, `adequate` and `progress`. Throws InputError in the same cases as
/// calibrate().
WrongParameters wrong_parameters(const plant::PlantModel& model, std::vector<record::Record> records,
                                 const CalibrateOptions& options);

/// Returns the result as a sentence, with "GENROU.Xd 1.44 -> 1.80 pu (or GENROU.Tdop: not distinguishable)"
/// for each parameter that must change.
std::string wrong_sentence(const fit::SparseSelection& found, double adequate);
/// The sentence and a table: old and new value, interval, evidence, and share of the error.
std::string wrong_text(const WrongParameters& w);
/// The result as JSON.
nlohmann::json wrong_json(const WrongParameters& w);

}  // namespace swingbank::validate::calibrate
