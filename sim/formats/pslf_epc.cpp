#include "sim/formats/pslf_epc.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string_view>

#include "sim/formats/detail/epc_reader.hpp"
#include "sim/formats/detail/pslf_text.hpp"

namespace swingbank::sim::formats {

bool is_epc(const std::filesystem::path& file) { return pslf::lower(file.extension().string()) == ".epc"; }

network::Network read_epc(const std::filesystem::path& file, const RawOptions& options) {
  return epc::EpcReader(psse::read_lines(file), file.string(), options).read();
}
network::Network parse_epc(const std::string& text, const std::string& name, const RawOptions& options) {
  return epc::EpcReader(psse::lines_of(text), name, options).read();
}
RawSurvey survey_epc(const std::filesystem::path& file, const RawOptions& options) {
  return epc::EpcReader(psse::read_lines(file), file.string(), options).survey();
}
RawSurvey parse_epc_survey(const std::string& text, const std::string& name, const RawOptions& options) {
  return epc::EpcReader(psse::lines_of(text), name, options).survey();
}

namespace epc {
namespace {

/// Parses a section header "bus data  [  9]   ty ...". Returns the section's name and announced number of
/// records; for other lines, an empty name.
std::pair<std::string, int> header_of(const std::string& line) {
  constexpr std::string_view word = " data";
  const std::string text = pslf::lower(psse::trimmed(line));
  if (text.empty() || std::isalpha(static_cast<unsigned char>(text[0])) == 0) return {};
  const auto data = text.find(word), open = text.find('['), close = text.find(']');
  if (data == std::string::npos || open == std::string::npos || close == std::string::npos || data > open ||
      open > close || !psse::trimmed(text.substr(data + word.size(), open - data - word.size())).empty())
    return {};
  const std::string number = psse::trimmed(text.substr(open + 1, close - open - 1));
  int count = 0;
  const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), count);
  if (error != std::errc{} || stop != number.data() + number.size() || count < 0) return {};
  return {psse::trimmed(text.substr(0, data)), count};
}

psse::Record record_of(const std::vector<pslf::Token>& tokens, int line) {
  psse::Record record{line, true, {}};
  for (const pslf::Token& token : tokens) record.fields.push_back({psse::trimmed(token.text), token.quoted});
  return record;
}

}  // namespace

std::vector<std::string> EpcReader::block(std::size_t& at) const {
  std::vector<std::string> lines;
  for (++at; at < lines_.size() && psse::trimmed(lines_[at]) != "!"; ++at) lines.push_back(lines_[at]);
  ++at;
  return lines;
}

void EpcReader::solution_parameters(const std::vector<std::string>& block, std::size_t first) {
  for (std::size_t i = 0; i < block.size(); ++i) {
    const int line = static_cast<int>(first + i) + 1;
    const psse::Record record = record_of(pslf::tokens_of(block[i], place(line), problems_), line);
    psse::Fields f(record, file_, problems_);
    if (pslf::lower(f.text(0, "")) == "sbase") base_ = static_cast<double>(f.number(1, "sbase"));
  }
}

/// Locates the sections of the file; read_sections() reads them in its own order.
void EpcReader::divide() {
  psse::erase_byte_order_mark(lines_);
  bool ended = false;
  std::size_t at = 0;
  while (at < lines_.size() && !ended) {
    const std::string text = pslf::lower(psse::trimmed(lines_[at]));
    if (const auto [name, count] = header_of(lines_[at]); !name.empty()) {
      sections_.push_back({name, count, ++at, at});
      continue;
    }
    if (text == "title") {
      for (const std::string& line : block(at)) {
        if (!network_.title.empty())
          network_.title += network_.title.find('\n') == std::string::npos ? "\n" : " ";
        network_.title += psse::trimmed(line);
      }
    } else if (text == "comments") {
      (void)block(at);
    } else if (text == "solution parameters") {
      const std::size_t first = at + 1;
      solution_parameters(block(at), first);
    } else {
      ended = text == "end";
      if (!ended && !pslf::says_nothing(lines_[at]) && text != "!") {
        if (sections_.empty())
          problems_.add("a line outside every section", place(static_cast<int>(at) + 1),
                        "an .epc is: title, comments, solution parameters, then 'bus data [count]' and so on",
                        "give a complete .epc");
        else
          sections_.back().last = at + 1;
      }
      ++at;
    }
    if (problems_.list().size() > 3) problems_.raise();  // probably another kind of file
  }
  if (std::ranges::none_of(sections_, [](const Section& s) { return s.name == "bus"; }))
    problems_.add("no 'bus data' section", file_, "a network has buses", "give a complete .epc");
  else if (!ended)
    problems_.add("the file ends without 'end'", place(static_cast<int>(lines_.size())),
                  "it may be truncated: sections at its end would be missing", "restore the file");
  if (!(base_ > 0.0L))
    problems_.add("no sbase above 0 MVA in the solution parameters", file_,
                  "powers and admittances refer to it", "give the line 'sbase 100.0'");
  if (options_.needs_frequency && !(options_.frequency_hz.value_or(0) > 0))
    problems_.add("no frequency", file_, "an .epc contains no frequency",
                  "give --frequency-hz (in a config: frequency_hz), 50 or 60 Hz");
  problems_.raise();  // reading the sections requires these values
  network_.base_mva = static_cast<double>(base_);
  network_.frequency = options_.frequency_hz.value_or(1.0);
}

void EpcReader::rows(const char* name, Reads take) {
  for (const Section& s : sections_) {
    if (s.name != name) continue;
    section_ = name;
    int count = 0;
    for (std::size_t at = s.first; at < s.last;) {
      if (pslf::says_nothing(lines_[at])) {
        ++at;
        continue;
      }
      const pslf::Line line = pslf::record_at(lines_, at, s.last, file_, problems_);
      ++count;
      if (!line.colon) {
        problems_.add("a record without ':'", place(line.number),
                      "in the " + s.name + " section a ':' separates the equipment from its values",
                      "correct the record");
        continue;
      }
      (this->*take)({record_of(line.head, line.number), record_of(line.tail, line.number), line.starts});
      generator_line_.resize(network_.generators.size(), line.number);
      branch_line_.resize(network_.branches.size(), line.number);
    }
    if (count != s.announced)
      problems_.add(std::to_string(count) + " records in the " + s.name + " section",
                    place(static_cast<int>(s.first)),
                    "its first line announces " + std::to_string(s.announced) + ": some may be lost",
                    "restore the file, or correct the number in brackets");
  }
}

void EpcReader::read_sections() {
  network_.origin = file_;
  divide();
  rows("bus", &EpcReader::bus);
  rows("branch", &EpcReader::branch);
  rows("shunt", &EpcReader::shunt);
  join_sections();
  rows("transformer", &EpcReader::transformer);
  rows("svd", &EpcReader::svd);
  rows("generator", &EpcReader::generator);
  rows("load", &EpcReader::load);
  rows("dc converter", &EpcReader::converter);
  rows("vs converter", &EpcReader::converter);
  report_left_out();
}

/// Adds remarks on non-empty sections that are not read.
void EpcReader::report_left_out() {
  constexpr std::array known = {"bus",   "branch", "transformer",  "generator",   "load",
                                "shunt", "svd",    "dc converter", "vs converter"};
  constexpr std::array nothing = {
      "area", "zone",       "owner",    "interface",  "transaction", "interface branch",
      "ba",   "substation", "injgroup", "injgrpelem", "dc bus",      "dc line"};
  for (const Section& s : sections_) {
    const auto is = [&](const char* name) { return s.name == name; };
    if (s.announced > 0 && std::ranges::none_of(known, is) && std::ranges::none_of(nothing, is))
      network_.remark("sections of the .epc that are not read",
                      s.name + " data, " + std::to_string(s.announced) + " records (" +
                          place(static_cast<int>(s.first)) + ")");
  }
}

network::Network EpcReader::read() {
  read_sections();
  check_network();
  complete_network([&](std::size_t i) { return place(generator_line_[i]); });
  problems_.raise();
  return std::move(network_);
}
RawSurvey EpcReader::survey() {
  units_only_ = true;
  read_sections();
  return take_survey();
}

std::string EpcReader::id_of(const psse::Fields& of, std::size_t i) {
  const std::string id = of.text(i, "1");
  return id.empty() ? "1" : id;
}

}  // namespace epc
}  // namespace swingbank::sim::formats
