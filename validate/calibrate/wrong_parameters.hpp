#pragma once
// Which parameters of a model are wrong, of several records, as text for the terminal and as JSON.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "validate/calibrate/calibrate.hpp"
#include "validate/fit/fewest.hpp"

namespace swingbank::validate::calibrate {

/// The fewest parameters that must change for the model to explain the events.
struct WrongParameters {
  fit::Fewest found;
  plant::PlantModel model;  ///< with these changed and every other one as it was
  double adequate = 0;      ///< chi2 per value up to which nothing but noise is left
  std::string sentence;
  [[nodiscard]] bool holds() const { return found.fit.misfit() <= adequate; }
};

/// Of the options spread, fixed parameters, events and the limit count; what is held out is left out. Throws
/// InputError as calibrate().
WrongParameters wrong_parameters(const plant::PlantModel& model, std::vector<record::Record> records,
                                 const CalibrateOptions& options);

/// "GENROU.Xd 1.44 -> 1.80 pu (or GENROU.Tdop: the records cannot tell)", and so on, or that none is.
std::string wrong_sentence(const fit::Fewest& found, double adequate);
/// The sentence, and a table with old, new, interval, evidence and share of the error.
std::string wrong_text(const WrongParameters& w);
nlohmann::json wrong_json(const WrongParameters& w);

}  // namespace swingbank::validate::calibrate
