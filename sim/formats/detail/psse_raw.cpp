#include "sim/formats/detail/psse_raw.hpp"

#include <algorithm>
#include <cctype>

#include "sim/network/consistency.hpp"

namespace swingbank::sim::formats {

network::Network read_raw(const std::filesystem::path& file) {
  return psse::RawReader(psse::read_lines(file), file.string()).read();
}
network::Network parse_raw(const std::string& text, const std::string& name) {
  return psse::RawReader(psse::lines_of(text), name).read();
}
RawSurvey survey_raw(const std::filesystem::path& file, std::optional<double> frequency_hz) {
  return psse::RawReader(psse::read_lines(file), file.string()).survey(frequency_hz);
}
RawSurvey parse_raw_survey(const std::string& text, const std::string& name,
                           std::optional<double> frequency_hz) {
  return psse::RawReader(psse::lines_of(text), name).survey(frequency_hz);
}

namespace psse {

const std::array<RawReader::Section, 22> RawReader::kSections = {{
    {"system-wide", Use::read, &RawReader::system_wide, 34},
    {"bus", Use::read, &RawReader::bus},
    {"load", Use::read, &RawReader::load},
    {"fixed shunt", Use::read, &RawReader::fixed_shunt},
    {"generator", Use::read, &RawReader::generator},
    {"branch", Use::read, &RawReader::branch},
    {"system switching device", Use::read, &RawReader::switching_device, 34},
    {"transformer", Use::read, &RawReader::transformer},
    {"area", Use::skip},
    {"two-terminal dc line", Use::refuse},
    {"voltage source converter dc line", Use::refuse},
    {"impedance correction", Use::skip},
    {"multi-terminal dc line", Use::refuse},
    {"multi-section line", Use::skip},
    {"zone", Use::skip},
    {"inter-area transfer", Use::skip},
    {"owner", Use::skip},
    {"FACTS device", Use::refuse},
    {"switched shunt", Use::read, &RawReader::switched_shunt},
    {"GNE device", Use::refuse},
    {"induction machine", Use::refuse, nullptr, 33},
    {"substation", Use::read, &RawReader::substation, 34},
}};

void RawReader::read_sections() {
  network_.origin = file_;
  header();
  for (const Section& s : kSections)
    if (s.since <= version_ && !left_out(s) && !section(s)) break;
}
network::Network RawReader::read() {
  read_sections();
  finish();
  problems_.raise();
  return std::move(network_);
}
RawSurvey RawReader::survey(std::optional<double> frequency_hz) {
  units_only_ = true;
  frequency_hz_ = frequency_hz;
  read_sections();
  return {std::move(network_), std::move(generator_line_), std::move(branch_line_), problems_.list()};
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
      f.number(1, "SBASE", 100.0L));  // the value the network holds, so that writing inverts reading
  version_ = f.integer(2, "REV");
  const double frequency = static_cast<double>(f.number(5, "BASFRQ", frequency_hz_));
  problems_.raise();  // without these nothing below can be read
  if (version_ < 32 || version_ > 35)
    throw InputError({"version " + std::to_string(version_) + " of the .raw format", f.where(),
                      "versions 32 to 35 are read", "save the case as one of these versions"});
  columns_ = columns(version_);
  if (change != 0)
    problems_.add("IC = " + std::to_string(change), f.where(), "the file adds to a case that is not here",
                  "save the whole case (IC = 0)");
  if (!(base_ > 0))
    problems_.add("SBASE = " + shortest(static_cast<double>(base_)) + " MVA", f.where(),
                  "everything is divided by it", "give a base > 0 MVA");
  if (!(frequency > 0))
    problems_.add("BASFRQ = " + shortest(frequency) + " Hz", f.where(), "the rotors turn at this frequency",
                  "give 50 or 60 Hz");
  network_.base_mva = static_cast<double>(base_);
  network_.frequency = frequency;
  network_.title = without_return(lines_[at_ + 1]) + "\n" + without_return(lines_[at_ + 2]);
  at_ += 3;
}

std::optional<Record> RawReader::next() {
  while (at_ < lines_.size()) {
    if (is_comment(lines_[at_])) {
      ++at_;
      continue;
    }
    Record record = split(lines_[at_], static_cast<int>(at_) + 1, file_, problems_);
    ++at_;
    if (!record.fields.empty()) return record;
  }
  return {};
}

bool RawReader::left_out(const Section& section) const {
  if (section.row != &RawReader::switching_device) return false;
  std::string text = separator_;
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text.find("BEGIN TRANSFORMER") != std::string::npos;
}

bool RawReader::section(const Section& section) {
  const std::string name = std::string(section.name) + " section";
  const int start = static_cast<int>(at_) + 1;
  while (auto record = next()) {
    const Field& first = record->fields[0];
    if (ends_section(*record)) {
      separator_ = lines_[static_cast<std::size_t>(record->line) - 1];
      return true;
    }
    if (ends_file(*record)) return false;
    // A bus record where the system-wide data should be: the file has none.
    if (section.row == &RawReader::system_wide && !first.quoted && parse_number(first.text)) {
      put_back(*record);
      return true;
    }
    if (section.use == Use::read) (this->*section.row)(*record);
    generator_line_.resize(network_.generators.size(), record->line);
    branch_line_.resize(network_.branches.size(), record->line);
    if (section.use == Use::refuse && !units_only_) {
      problems_.add("a record in the " + name, file_ + ":" + std::to_string(record->line),
                    "this equipment is not modelled", "remove it or replace it by an equivalent load");
      while (auto rest = next()) {  // one problem per section says it all; its records may span lines
        if (ends_file(*rest)) return false;
        if (ends_section(*rest) && rest->fields.size() == 1) return true;
      }
    }
  }
  problems_.add("the file ends in the " + name, file_ + ":" + std::to_string(lines_.size()),
                "the section begins at line " + std::to_string(start) +
                    " and neither '0' nor 'Q' ends it: the file is truncated",
                "restore the file");
  return false;
}

// Solution settings and names of ratings: nothing in it changes the equations.
void RawReader::system_wide(const Record&) {}

int RawReader::find_bus(int number, const Fields& fields) {
  const auto found = index_.find(number);
  if (found != index_.end()) return found->second;
  problems_.add("bus " + std::to_string(number) + " is not in the bus section", fields.where(),
                "the record refers to it", "add the bus or correct the number");
  return -1;
}

void RawReader::once(const std::string& identity, const Fields& fields) {
  const auto [found, fresh] = seen_.emplace(identity, fields.line());
  if (!fresh)
    problems_.add(identity + " appears twice", fields.where(),
                  "it is already on line " + std::to_string(found->second),
                  "remove one or give it another id");
}

void RawReader::once_branch(int from, int to, const std::string& circuit, const Fields& fields) {
  once("branch " + std::to_string(std::min(from, to)) + "-" + std::to_string(std::max(from, to)) +
           " circuit '" + circuit + "'",
       fields);
}

bool RawReader::status(int value, const char* name, const Fields& fields) {
  if (value != 0 && value != 1)
    problems_.add(std::string(name) + " = " + std::to_string(value), fields.where(), "a status is 0 or 1",
                  "give 1 (in service) or 0 (out of service)");
  return value == 1;
}

void RawReader::finish() {
  network::settle_isolated(network_);
  for (const int star : stars_)  // a star point whose windings are all out hangs on nothing
    if (std::ranges::none_of(network_.branches,
                             [&](const network::Branch& b) { return b.to == star && b.in_service; }))
      network_.buses[static_cast<std::size_t>(star)].type = network::BusType::isolated;
  network::check_held_voltages(
      network_, [&](std::size_t i) { return file_ + ":" + std::to_string(generator_line_[i]); }, problems_);
  if (network_.buses.empty() && problems_.empty())
    problems_.add("no buses", file_, "the bus section is empty", "give a case with buses");
  network::check_finite(network_, file_, problems_);
}

}  // namespace psse
}  // namespace swingbank::sim::formats
