#include "sim/formats/detail/psse_raw.hpp"

#include <algorithm>
#include <cmath>

#include "base/capitals.hpp"

namespace swingbank::sim::formats {

namespace {
bool is_rawx(const std::string& name) { return name.ends_with(".rawx") || name.ends_with(".RAWX"); }

/// Throws InputError with the likely version if the errors are due to a wrong version.
void refuse_wrong_version(const std::vector<std::string>& lines, const std::string& name,
                          const RawOptions& options, int read_as, const std::vector<Problem>& faults) {
  if (const auto other = psse::other_version(lines, name, options, read_as, faults)) throw InputError(*other);
}
network::Network read_lines_as_raw(const std::vector<std::string>& lines, const std::string& name,
                                   const RawOptions& options) {
  psse::RawReader reader(lines, name, options);
  try {
    return reader.read();
  } catch (const InputError& error) {
    refuse_wrong_version(lines, name, options, reader.version(), error.problems());
    throw;
  }
}
RawSurvey survey_lines(const std::vector<std::string>& lines, const std::string& name,
                       const RawOptions& options) {
  psse::RawReader reader(lines, name, options);
  RawSurvey survey = reader.survey();
  refuse_wrong_version(lines, name, options, reader.version(), survey.faults);
  return survey;
}
}  // namespace

network::Network read_raw(const std::filesystem::path& file, const RawOptions& options) {
  return read_lines_as_raw(psse::read_lines(file), file.string(), options);
}
network::Network parse_raw(const std::string& text, const std::string& name, const RawOptions& options) {
  return read_lines_as_raw(psse::lines_of(text), name, options);
}
RawSurvey survey_raw(const std::filesystem::path& file, const RawOptions& options) {
  return survey_lines(psse::read_lines(file), file.string(), options);
}
RawSurvey parse_raw_survey(const std::string& text, const std::string& name, const RawOptions& options) {
  return survey_lines(psse::lines_of(text), name, options);
}

namespace psse {

std::vector<RawReader::Section> RawReader::sections() const {
  const Section load{"load", &RawReader::load}, generator{"generator", &RawReader::generator},
      branch{"branch", &RawReader::branch}, area{"area"},
      dc{"two-terminal dc line", &RawReader::two_terminal_dc},
      vsc{"voltage source converter dc line", &RawReader::vsc_dc},
      table{"impedance correction", &RawReader::correction_table},
      mtdc{"multi-terminal dc line", &RawReader::multi_terminal_dc}, multi{"multi-section line"},
      zone{"zone"}, transfer{"inter-area transfer"}, owner{"owner"}, facts{"FACTS device", &RawReader::facts},
      switched{"switched shunt", &RawReader::switched_shunt},
      transformer{"transformer", &RawReader::transformer};
  std::vector<Section> list;
  const auto add = [&](std::initializer_list<Section> more) { list.insert(list.end(), more); };
  if (version_ < 28) {
    if (version_ == 23)
      add({{"bus", &RawReader::bus_23}});
    else
      add({{"bus", &RawReader::bus}, load});
    add({generator,
         branch,
         {"transformer adjustment"},
         area,
         dc,
         switched,
         table,
         mtdc,
         multi,
         zone,
         transfer});
    if (version_ != 24) add({owner});
    if (version_ != 24 && version_ != 25) add({facts});
    return list;
  }
  if (version_ >= 34) add({{"system-wide", &RawReader::system_wide}});
  add({{"bus", &RawReader::bus}, load});
  if (version_ >= 31) add({{"fixed shunt", &RawReader::fixed_shunt}});
  add({generator, branch});
  if (version_ >= 34) add({{"system switching device", &RawReader::switching_device}});
  add({transformer, area, dc});
  if (version_ >= 29) add({vsc});
  if (version_ < 31) add({switched});
  add({table, mtdc, multi, zone, transfer, owner, facts});
  if (version_ >= 31) add({switched});
  if (version_ >= 32) add({{"GNE device", &RawReader::gne}});
  if (version_ >= 33) add({{"induction machine", &RawReader::induction_machine}});
  if (version_ >= 34) add({{"substation", &RawReader::substation}});
  return list;
}

void RawReader::read_sections() {
  network_.origin = file_;
  if (erase_byte_order_mark(lines_))
    network_.remark("a byte-order mark before the first line is ignored", file_ + ":1");
  if (is_rawx(file_)) return read_json();
  header();
  bool area_behind = false;  // the sections from "area" on are optional
  for (const Section& s : sections()) {
    if (left_out(s)) continue;
    area_behind = area_behind || std::string_view(s.name) == "area";
    if (!section(s, area_behind)) break;
    while (!s.row && again(s)) {
      network_.remark("sections whose title appears a second time are continued",
                      std::string(s.name) + " section after " + file_ + ":" + std::to_string(at_));
      if (!section(s, false)) break;
    }
  }
}
network::Network RawReader::read() {
  read_sections();
  finish();
  problems_.raise();
  return std::move(network_);
}
RawSurvey RawReader::survey() {
  units_only_ = true;
  read_sections();
  correct_impedances();
  return take_survey();
}

namespace {
bool is_comment(const std::string& line) {
  const auto first = line.find_first_not_of(" \t");
  return first != std::string::npos && line.compare(first, 2, "@!") == 0;
}
std::string without_return(std::string line) {
  while (!line.empty() && line.back() == '\r') line.pop_back();
  return line;
}
}  // namespace

void RawReader::header() {
  while (at_ < lines_.size() && is_comment(lines_[at_])) ++at_;
  if (lines_.size() < at_ + 3)
    throw InputError({"the file has " + std::to_string(lines_.size()) + " lines", file_,
                      "a .raw begins with a header and two title lines; it may be truncated",
                      "give a complete .raw file"});
  const Record record = split(lines_[at_], static_cast<int>(at_) + 1, file_, problems_);
  Fields f(record, file_, problems_);
  const int change = f.integer(0, "IC", 0);
  base_ = static_cast<double>(
      f.number(1, "SBASE", 100.0L));  // rounded to double as Network::base_mva, for an exact round trip
  std::string comment;
  if (const auto slash = lines_[at_].find('/'); slash != std::string::npos)
    comment = "; the line says \"" + without_return(lines_[at_].substr(slash + 1)) + "\"";
  if (f.text(2, "").empty() && options_.version == 0)
    problems_.add("REV is missing", f.where(),
                  "the order of fields and sections depends on the version" + comment,
                  "give it with --raw-version, 23 to 35");
  else
    version_ = forced_ != 0 ? forced_ : f.integer(2, "REV", options_.version);
  if (f.text(5, "").empty() && !options_.frequency_hz && options_.needs_frequency)
    problems_.add("BASFRQ is missing", f.where(), "the swing equations need the system frequency",
                  "give it with --frequency-hz, 50 or 60 Hz");
  const double frequency = static_cast<double>(f.number(5, "BASFRQ", options_.frequency_hz.value_or(1.0)));
  problems_.raise();  // reading the sections requires these values
  if (version_ < 23 || version_ > 35)
    throw InputError({"version " + std::to_string(version_) + " of the .raw format", f.where(),
                      "versions 23 to 35 are read", "save the case as one of these versions"});
  if (f.text(2, "").empty())
    network_.remark("REV is taken from --raw-version: " + std::to_string(version_), f.where());
  if (f.text(5, "").empty() && options_.frequency_hz)
    network_.remark("BASFRQ is taken from --frequency-hz: " + shortest(frequency) + " Hz", f.where());
  columns_ = columns(version_);
  check_header(f, change, frequency);
  check_titles();
  network_.title = without_return(lines_[at_ + 1]) + "\n" + without_return(lines_[at_ + 2]);
  at_ += 3;
}

/// Throws InputError if a title line looks like a bus record, which means that a title line is missing.
void RawReader::check_titles() {
  for (std::size_t i = at_ + 1; i <= at_ + 2; ++i) {
    Problems ignored;
    const Record record = split(lines_[i], static_cast<int>(i) + 1, file_, ignored);
    const auto value = [&](std::size_t k) {
      const bool given = k < record.fields.size() && !record.fields[k].quoted;
      return given ? parse_number(record.fields[k].text) : std::nullopt;
    };
    const auto type = value(version_ == 23 ? 1 : 3), number = value(0);
    const auto numbers = std::ranges::count_if(
        record.fields, [](const Field& f) { return !f.quoted && parse_number(f.text); });
    const auto vm = value(columns_.bus_voltage);  // may be empty
    constexpr int least = 6;                      // minimum count of numbers in a bus record of any version
    if (!type || !number || *type < 1 || *type > 4 || *type != std::trunc(*type) || *number < 1 ||
        *number != std::trunc(*number) || numbers < least || (vm && (*vm < 0 || *vm > 2)))
      continue;
    throw InputError({"line " + std::to_string(i + 1) + " looks like a bus record",
                      file_ + ":" + std::to_string(i + 1),
                      "two title lines follow the header, and this would be the " +
                          std::string(i == at_ + 1 ? "first" : "second"),
                      "insert the missing title line after the header; it may be empty"});
  }
}

void RawReader::check_header(const Fields& f, int change, double frequency) {
  if (change != 0)
    problems_.add("IC = " + std::to_string(change), f.where(), "the file contains changes to another case",
                  "save the whole case (IC = 0)");
  if (!(base_ > 0))
    problems_.add("SBASE = " + shortest(static_cast<double>(base_)) + " MVA", f.where(),
                  "all per-unit values refer to it", "give a base > 0 MVA");
  if (!(frequency > 0))
    problems_.add("BASFRQ = " + shortest(frequency) + " Hz", f.where(),
                  "the swing equations need the system frequency", "give 50 or 60 Hz");
  network_.base_mva = static_cast<double>(base_);
  network_.frequency = frequency;
}

std::optional<Record> RawReader::next() {
  while (at_ < lines_.size()) {
    if (is_comment(lines_[at_])) {
      ++at_;
      continue;
    }
    Record record = split(lines_[at_], static_cast<int>(at_) + 1, file_, problems_, kCommentMarks);
    ++at_;
    if (!record.fields.empty()) return record;
  }
  return {};
}

bool RawReader::left_out(const Section& section) const {
  return section.row == &RawReader::switching_device &&
         capitals(separator_).find("BEGIN TRANSFORMER") != std::string::npos;
}
bool RawReader::again(const Section& section) const {
  return capitals(separator_).find("BEGIN " + capitals(section.name)) != std::string::npos;
}

bool RawReader::section(const Section& section, bool may_be_missing) {
  const std::string name = std::string(section.name) + " section";
  const int start = static_cast<int>(at_) + 1;
  const auto blank = [](const std::string& l) { return without_return(l).empty(); };
  if (may_be_missing && std::all_of(lines_.begin() + static_cast<std::ptrdiff_t>(at_), lines_.end(), blank)) {
    network_.remark("the file ends before its last sections, which are taken as empty", "from the " + name);
    return false;
  }
  while (auto record = next()) {
    const Field& first = record->fields[0];
    if (ends_section(*record)) {
      separator_ = lines_[static_cast<std::size_t>(record->line) - 1];
      return true;
    }
    if (ends_file(*record)) return false;
    // A bus record here means that the file has no system-wide section.
    if (section.row == &RawReader::system_wide && !first.quoted && parse_number(first.text)) {
      put_back(*record);
      return true;
    }
    section_ = section.name;
    if (section.row) (this->*section.row)(*record);
    if (problems_.list().size() > most_faults_) problems_.raise();
    generator_line_.resize(network_.generators.size(), record->line);
    branch_line_.resize(network_.branches.size(), record->line);
  }
  problems_.add("the file ends in the " + name, file_ + ":" + std::to_string(lines_.size()),
                "the section begins at line " + std::to_string(start) +
                    " and neither '0' nor 'Q' ends it: the file is truncated",
                "restore the file");
  return false;
}

// Ignored: solution settings and names of ratings do not affect the equations.
void RawReader::system_wide(const Record&) {}

std::optional<std::string> RawReader::circuit_of(int from, int to, const std::string& circuit,
                                                 const Fields& fields) {
  return identities_.id(
      {network::Duplicate::Kind::branch, {from, to}},
      "branch " + std::to_string(std::min(from, to)) + "-" + std::to_string(std::max(from, to)) + " circuit",
      circuit, "", fields);
}

void RawReader::finish() {
  correct_impedances();
  if (network_.buses.empty() && problems_.empty())
    problems_.add("no buses", file_, "the bus section is empty", "give a case with buses");
  check_network();
  for (std::size_t i = 0; i < network_.generators.size(); ++i)
    if (network::Generator& g = network_.generators[i]; regulated_[i] != 0 && g.in_service) {
      const auto found = index_.find(std::abs(regulated_[i]));
      if (found == index_.end())
        regulate_own_bus(g, "generators that regulate a missing bus regulate their own at the file's voltage",
                         generator_place(i));
      else if (found->second != g.bus)
        g.regulated = found->second;
    }
  complete_network([&](std::size_t i) { return generator_place(i); });
}

}  // namespace psse
}  // namespace swingbank::sim::formats
