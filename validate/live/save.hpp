#pragma once
// Saving of a step: plant file, PSS/E and PSLF records, and report.
#include "base/output_folder.hpp"
#include "validate/live/session.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::live {

/// Returns the names of the files that save() may write.
std::vector<std::string> saved_files();
/// Writes the model of a step and the report of its comparison into the folder. Returns {"files": [paths],
/// "notes": [text], "model": path of the plant file, "command": command line that compares it}.
nlohmann::json save(const Session& session, int step, OutputFolder& folder,
                    const report::Provenance& provenance);

}  // namespace swingbank::validate::live
