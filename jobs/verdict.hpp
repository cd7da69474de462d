#pragma once
// Shared code of the commands that judge a model: acceptance limits, signature and provenance of a page.
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "base/inputs_kept.hpp"
#include "base/sha256.hpp"
#include "jobs/command_line.hpp"
#include "jobs/event_records.hpp"
#include "jobs/print_pdf.hpp"
#include "jobs/software.hpp"
#include "sim/plant/parameter_id.hpp"
#include "validate/compare/page_parts.hpp"

namespace swingbank::jobs {

/// Options of a judgement: acceptance limits, signature and PDF output.
struct Judging {
  std::string accept, signed_by, pdf, standard;
  validate::thresholds::Acceptance by;

  /// Declares the options. `preset`: acceptance limits if --accept is missing.
  Option add_to(CommandLine& line,
                const std::string& preset = validate::thresholds::acceptance_presets().front()) {
    standard = preset;
    line.add("--pdf", pdf, "also write the report as PDF to this file (requires Chromium)");
    line.add_flag("--quiet", quiet, "print errors and the result only");
    line.add("--by", signed_by, "name of the signer: printed on the page with date and inputs");
    return line.add(
        "--accept", accept,
        fmt::format(
            "acceptance limits for the fit-for-purpose verdict: a file (configs/accept/README.md), or "
            "the preset {} (default: {})",
            fmt::join(validate::thresholds::acceptance_presets(), " or "), preset));
  }
  /// Reads the limits and checks --pdf; call it before the work. Throws InputError.
  void read() {
    Problems problems;
    try {
      by = validate::thresholds::read_acceptance(accept.empty() ? standard : accept);
    } catch (const InputError& error) {
      problems.add(error);
    }
    if (!pdf.empty()) browser_for(pdf, problems);
    problems.raise();
  }
  /// Returns the outputs outside the command's output folder.
  [[nodiscard]] std::vector<Output> outputs() const {
    return pdf.empty() ? std::vector<Output>{} : std::vector<Output>{{pdf, "--pdf"}};
  }
  /// Prints the finished page to the file of --pdf, if given.
  void print(const std::filesystem::path& page) const {
    if (!pdf.empty()) print_pdf(page, pdf);
  }
};

/// Returns all files of one value of --records: "A+B" names two files, and a .cfg implies its .dat.
inline std::vector<std::filesystem::path> files_of(const std::string& word) {
  std::vector<std::filesystem::path> files;
  for (const auto& source : validate::record::Source(word).files)
    for (const auto& file : source.all_files()) files.push_back(file);
  return files;
}

/// Adds signer, date, commit, limits and the SHA-256 hashes of model, records and limits file to the
/// provenance of a page.
inline void sign(validate::report::Provenance& rows, const Judging& judging, const std::string& model,
                 const std::vector<std::string>& records) {
  if (!judging.signed_by.empty()) rows.insert(rows.begin(), {"signed by", judging.signed_by});
  rows.emplace_back("made", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr))));
  rows.emplace_back("commit", commit());
  rows.emplace_back("limits", judging.by.name + ": " + judging.by.source);
  std::vector<std::filesystem::path> files = {model};
  for (const auto& word : records)
    for (const auto& file : files_of(word)) files.push_back(file);
  if (std::filesystem::exists(judging.accept)) files.emplace_back(judging.accept);
  for (const auto& file : files)
    if (const std::string hash = sha256_of_file(file); !hash.empty())
      rows.emplace_back("SHA-256", hash + "  " + file.string());
}

/// Returns the fitted parameters as rows of a page, with their textbook symbols.
template <class Fitted>
std::vector<validate::compare::PageParameter> page_parameters(const std::vector<Fitted>& fitted,
                                                              const sim::plant::Plant& plant) {
  std::vector<validate::compare::PageParameter> rows;
  for (const auto& p : fitted)
    rows.push_back({p.block, std::string(sim::plant::parameter_record(plant, p.where.id).symbol), p.unit,
                    p.start, p.value, p.low, p.high, p.decided,
                    p.at_bound ? "at its bound: interval not valid" : ""});
  return rows;
}

}  // namespace swingbank::jobs
