#pragma once
// What a diagnosis says of laws, for its page, its JSON and the terminal.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "validate/diagnose/diagnose.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::diagnose {

/// The inferred input against every signal, the laws tried, and the file of the one that was found. Nothing
/// where no law was searched.
void laws_on_page(const Diagnosis& d, report::Page& page);
/// null where no law was searched.
nlohmann::json laws_json(const Diagnosis& d);
std::string laws_text(const Diagnosis& d);

}  // namespace swingbank::validate::diagnose
