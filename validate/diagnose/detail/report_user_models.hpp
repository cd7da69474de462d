#pragma once
// Results of the search for user-defined models, for the page, the JSON and the terminal.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "validate/diagnose/diagnose.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::diagnose {

/// Adds plots of the inferred input over time and against every signal, and a table of the models tried. Does
/// nothing if there was no search.
void user_models_on_page(const Diagnosis& d, report::Document& page);
/// Returns the results as JSON; null if there was no search.
nlohmann::json user_models_json(const Diagnosis& d);
/// Returns the results as terminal text; empty if there was no search.
std::string user_models_text(const Diagnosis& d);

}  // namespace swingbank::validate::diagnose
