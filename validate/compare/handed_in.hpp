#pragma once
// Submitted model: its nameplate and usability, as parts of a report.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "validate/compare/compare.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/report/document.hpp"
#include "validate/usability/usability.hpp"

namespace swingbank::validate::compare {

/// Submitted model with the information that a verification report requires.
struct HandedIn {
  std::string name, file, sha256;  ///< name; the plant file that the command read, and its hash
  double mva = 0;                  ///< machine base [MVA]
  std::vector<plant::NameplateLine> nameplate = {};  ///< given and missing fields
  usability::Usability usability = {};               ///< at the operating points of the events
};
/// Returns the nameplate of the model and its usability at the operating points of the events.
HandedIn handed_in(const plant::PlantModel& model, const std::vector<EventComparison>& events);

/// Adds the section with the nameplate; missing fields are listed as "missing".
void nameplate_part(report::Document& page, const HandedIn& model);
/// Adds the section with the verdict and the table of the usability check.
void usability_part(report::Document& page, const HandedIn& model);
/// Returns usability and nameplate as terminal text: verdict, largest drift, smallest damping ratio and
/// failures of the usability check, and the missing fields of the nameplate.
std::string handed_in_text(const HandedIn& model);
/// Returns given and missing fields of the nameplate as JSON; dates and texts as text, ratings as numbers.
nlohmann::json nameplate_json(const HandedIn& model);

}  // namespace swingbank::validate::compare
