// Detection of files of a wrong kind or version, to report one error in place of one per line.
#include <array>
#include <cctype>

#include "sim/formats/detail/psse_raw.hpp"

namespace swingbank::sim::formats {
namespace {

/// Returns the first line that has fields, as a record. Returns none if there is no such line or the file
/// cannot be read; the file's reader reports that error.
std::optional<psse::Record> first_record(const std::filesystem::path& file) {
  try {
    Problems ignored;
    const auto lines = psse::read_lines(file);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto begin = lines[i].find_first_not_of(" \t\r");
      if (begin == std::string::npos || lines[i].compare(begin, 2, "//") == 0 ||
          lines[i].compare(begin, 2, "@!") == 0)
        continue;
      auto record = psse::split(lines[i], static_cast<int>(i) + 1, file.string(), ignored);
      if (!record.fields.empty()) return record;
    }
  } catch (const InputError&) {
  }
  return {};
}
bool is_number(const psse::Field& field) { return !field.quoted && psse::parse_number(field.text); }
/// Returns true if a record begins as in a .dyr: a bus number or quoted equipment name, and a quoted model
/// name.
bool is_of_dyr(const psse::Record& r) {
  return r.fields.size() > 1 && (r.fields[0].quoted || is_number(r.fields[0])) && r.fields[1].quoted &&
         !r.fields[1].text.empty() && std::isalpha(static_cast<unsigned char>(r.fields[1].text[0])) != 0;
}
/// Returns true if a record begins as in a .raw (IC and SBASE) or a .rawx (a brace).
bool is_of_raw(const psse::Record& r) {
  return r.fields[0].text.starts_with('{') ||
         (r.fields.size() > 1 && is_number(r.fields[0]) && is_number(r.fields[1]));
}
std::string place(const std::filesystem::path& file, const psse::Record& record) {
  return file.string() + ":" + std::to_string(record.line);
}

}  // namespace

void refuse_exchanged(const std::filesystem::path& raw, const std::filesystem::path& dyr) {
  const auto network = first_record(raw), dynamics = first_record(dyr);
  const bool no_raw = network && is_of_dyr(*network), no_dyr = dynamics && is_of_raw(*dynamics);
  if (no_raw && no_dyr)
    throw InputError(
        {"the two files are exchanged", place(raw, *network),
         "the file given as .raw begins with a record of a dynamic model, the file given as .dyr "
         "with the header of a .raw",
         "exchange --raw and --dyr"});
  if (no_raw)
    throw InputError({"not a .raw file", place(raw, *network),
                      "the file begins with a record of a dynamic model, '" + network->fields[1].text +
                          "', as a .dyr does",
                      "give the network's file with --raw"});
  if (no_dyr)
    throw InputError({"not a .dyr file", place(dyr, *dynamics), "the file begins with the header of a .raw",
                      "give the dynamic models' file with --dyr"});
}

namespace psse {

std::size_t RawReader::faults_as(int version, std::size_t most) {
  forced_ = version;
  most_faults_ = most;
  units_only_ = true;
  try {
    read_sections();
  } catch (const InputError& error) {
    return error.problems().size();
  }
  return problems_.list().size();
}

std::optional<Problem> other_version(const std::vector<std::string>& lines, const std::string& name,
                                     const RawOptions& options, int read_as,
                                     const std::vector<Problem>& faults) {
  // Fewer than kReportedSingly errors are reported one by one. Another version is likely if it has at most
  // 1/kTimesFewer of the errors.
  constexpr std::size_t kReportedSingly = 3, kTimesFewer = 10;
  if (faults.size() < kReportedSingly || read_as == 0) return {};
  constexpr std::array kVersions = {33, 34, 35, 32, 31, 30, 29, 28, 27, 26, 25, 24, 23};
  std::size_t least = faults.size() / kTimesFewer;
  int best = 0;
  for (const int version : kVersions) {
    if (version == read_as) continue;
    const std::size_t left = RawReader(lines, name, options).faults_as(version, least);
    if (left > least || (best != 0 && left == least)) continue;
    least = left;
    best = version;
  }
  if (best == 0) return {};
  return Problem{
      std::to_string(faults.size()) + " errors when read as version " + std::to_string(read_as), name,
      "read as version " + std::to_string(best) + " it has " +
          (least == 0 ? std::string("none") : std::to_string(least)) +
          "; the first error: " + faults[0].what + " at " + faults[0].where,
      options.version == read_as ? "give --raw-version " + std::to_string(best)
                                 : "correct REV in the header, in a copy, to " + std::to_string(best)};
}

}  // namespace psse
}  // namespace swingbank::sim::formats
