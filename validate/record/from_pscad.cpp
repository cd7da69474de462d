// Reader of PSCAD output: the list of channels (.inf) and its text files of ten channels each (_01.out, ...).
// Source: PSCAD 5.0.2 Online Help, "EMTDC Output" (Text *.inf/*.out Format Files): the first row is the
// project's description, the first column is the time [s], and a file has at most ten channels.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <utility>

#include "base/sha256.hpp"
#include "validate/record/detail/build.hpp"
#include "validate/record/detail/phase.hpp"
#include "validate/record/detail/text.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::record {
namespace {

constexpr std::size_t kChannelsPerPart = 10;

/// One line of the .inf.
struct PscadChannel {
  std::size_t number = 0;  ///< n of PGB(n), from 1
  std::string name, group, unit;
  int line = 0;
};

/// Splits a line at blanks.
void split_blanks(std::string_view line, std::vector<std::string_view>& cells) {
  cells.clear();
  for (std::size_t at = line.find_first_not_of(" \t"); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    cells.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(" \t", end);
  }
}

/// Parses a number as Fortran writes it: also "1D-3", and "1-100" with a three-digit exponent. Returns no
/// value for other text, such as an overflowing field "****".
std::optional<double> fortran_number(std::string_view cell) {
  if (cell.starts_with('+')) cell.remove_prefix(1);
  double value = 0;
  const char* const last = cell.data() + cell.size();
  const auto [end, error] = std::from_chars(cell.data(), last, value);
  if (error == std::errc{} && end == last) return value;
  std::string text;
  for (const char c : cell) {
    if ((c == '-' || c == '+') && !text.empty() && std::isdigit(static_cast<unsigned char>(text.back())))
      text += 'E';
    if (c != '+') text += c == 'D' || c == 'd' ? 'E' : c;
  }
  const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (stop != text.data() + text.size() || text.empty()) return std::nullopt;
  if (fault == std::errc::result_out_of_range && text.find("E-") != std::string::npos) return 0.0;
  return fault == std::errc{} ? std::optional(value) : std::nullopt;
}

/// Returns the channels in the order of their numbers; adds a problem for each faulty line.
std::vector<PscadChannel> parse_inf(std::string_view text, const std::string& file, Problems& problems) {
  static const std::regex of_number(R"(^\s*PGB\s*\(\s*(\d{1,6})\s*\))"),
      of_name(R"re(Desc\s*=\s*"([^"]*)")re"), of_group(R"re(Group\s*=\s*"([^"]*)")re"),
      of_unit(R"re(Units\s*=\s*"([^"]*)")re");
  std::map<std::size_t, PscadChannel> all;
  int number = 0;
  while (!text.empty()) {
    const std::string line(take_line(text));
    ++number;
    if (line.find("PGB") == std::string::npos) continue;
    const std::string where = fmt::format("{}:{}", file, number);
    std::smatch n, name, match;
    if (!std::regex_search(line, n, of_number) || n[1] == "0" || !std::regex_search(line, name, of_name)) {
      problems.add("a channel without number or name", where,
                   "a line is PGB(1) Output Desc=\"V\" Group=\"Main\" Max=2.0 Min=-2.0 Units=\"pu\"",
                   "run the case again, so that PSCAD writes the file");
      continue;
    }
    PscadChannel c{std::stoul(n[1]), name[1], {}, {}, number};
    if (std::regex_search(line, match, of_group)) c.group = match[1];
    if (std::regex_search(line, match, of_unit)) c.unit = match[1];
    if (const auto [before, added] = all.emplace(c.number, c); !added)
      problems.add(fmt::format("PGB({}) twice", c.number), where,
                   fmt::format("line {} has this number", before->second.line),
                   "run the case again, so that PSCAD writes the file");
  }
  if (all.empty() && problems.empty())
    problems.add("no channels", file, "no line begins with PGB(1)",
                 "give the .inf that PSCAD writes beside the .out files");
  std::vector<PscadChannel> channels;
  for (auto& [key, c] : all) channels.push_back(std::move(c));
  return channels;
}

/// One .out file: its rows, parsed for the chosen channels only.
struct OutFile {
  std::string file;
  std::size_t width = 0;                                        ///< number of columns, including the time
  std::vector<std::pair<std::size_t, RawColumn*>> chosen = {};  ///< column, from 1, and destination
  std::vector<double> t = {};
  std::vector<int> lines = {};  ///< line of each row
};

/// Consecutive rows without a finite number in one column.
struct BadRun {
  std::string cell;
  int first = 0, last = 0;
};

class OutReader {
 public:
  OutReader(OutFile& part, std::string_view text, const ReadOptions& options, Problems& problems)
      : part_(part), text_(text), options_(options), problems_(problems), runs_(part.chosen.size()) {}

  void read() {
    while (!text_.empty()) {
      const bool ended = text_.find('\n') != std::string_view::npos;
      const std::string_view line = take_line(text_);
      ++number_;
      split_blanks(line, cells_);
      if (cells_.empty() || (number_ == 1 && is_description())) continue;
      const bool last = text_.find_first_not_of(" \t\r\n\x1a") == std::string_view::npos;
      // Columns have a fixed width, so a shorter last line without a line end is truncated within a number.
      const bool shorter = length_ > 0 && length_ == before_ && line.size() < length_;
      if (last && !ended && (cells_.size() < part_.width || shorter)) {
        problems_.add("a truncated last line", fmt::format("{}:{}", part_.file, number_),
                      "the simulation or the copy ended while it was written",
                      "run the case again, or delete the last line of every .out file");
        break;
      }
      before_ = std::exchange(length_, line.size());
      if (cells_.size() != part_.width)
        bad_width();
      else
        row();
    }
    if (wrong_ > 0)
      problems_.add(
          fmt::format("{} columns in {} {}", width_seen_, wrong_, wrong_ == 1 ? "row" : "rows"),
          fmt::format("{}:{}", part_.file, first_wrong_),
          fmt::format("the .inf lists {} channels of this file, so it must have {} columns including "
                      "the time",
                      part_.width - 1, part_.width),
          "run the case again, so that the .inf and the .out files belong together");
    for (std::size_t c = 0; c < runs_.size(); ++c) report(c);
  }

 private:
  /// Whether the first line is the project's description, not a row of numbers.
  [[nodiscard]] bool is_description() const {
    return cells_.size() != part_.width ||
           !std::ranges::all_of(cells_, [](auto cell) { return fortran_number(cell).has_value(); });
  }
  void bad_width() {
    if (wrong_++ > 0) return;
    first_wrong_ = number_;
    width_seen_ = cells_.size();
  }
  void row() {
    const auto t = fortran_number(cells_[0]);
    if (!t || !std::isfinite(*t)) {
      problems_.add(fmt::format("time = '{}'", cells_[0]), fmt::format("{}:{}", part_.file, number_),
                    "it is not a number", "run the case again");
      return;
    }
    part_.t.push_back(*t);
    part_.lines.push_back(number_);
    for (std::size_t c = 0; c < part_.chosen.size(); ++c) {
      const std::string_view cell = cells_[part_.chosen[c].first];
      const auto v = fortran_number(cell);
      if ((!v || !std::isfinite(*v)) && *t >= options_.from && *t <= options_.until) {
        auto& runs = runs_[c];
        if (!runs.empty() && runs.back().last == number_ - 1)
          runs.back().last = number_;
        else
          runs.push_back({std::string(cell), number_, number_});
      }
      part_.chosen[c].second->values.push_back(v.value_or(kNoValue));
    }
  }
  void report(std::size_t c) {
    constexpr std::size_t kRunsShown = 3;
    const std::string& name = part_.chosen[c].second->name;
    for (std::size_t k = 0; k < std::min(kRunsShown, runs_[c].size()); ++k) {
      const BadRun& run = runs_[c][k];
      const std::size_t more = k + 1 == kRunsShown ? runs_[c].size() - kRunsShown : 0;
      problems_.add(fmt::format("{} = '{}'", name, run.cell),
                    run.first == run.last ? fmt::format("{}:{}", part_.file, run.first)
                                          : fmt::format("{}:{}-{}", part_.file, run.first, run.last),
                    more > 0 ? fmt::format("the value is not finite (also at {} further places)", more)
                             : "the value is not finite",
                    "correct the case, or end before it with --until");
    }
  }

  OutFile& part_;
  std::string_view text_;
  const ReadOptions& options_;
  Problems& problems_;
  std::vector<std::vector<BadRun>> runs_;  ///< [chosen channel]
  std::vector<std::string_view> cells_;
  std::size_t length_ = 0, before_ = 0,
              width_seen_ = 0;  ///< lengths of the last two lines; cells of the first wrong row
  int number_ = 0, wrong_ = 0, first_wrong_ = 0;
};

/// Returns three channels that are the phases of one quantity, "Va, Vb, Vc"; empty if there are none.
std::string three_phases(const std::vector<PscadChannel>& channels) {
  static const std::regex of_phase(R"(([vuei]\w*?)[_:\s]*(a|b|c|l1|l2|l3|ab|bc|ca|1|2|3))",
                                   std::regex::icase);
  std::map<std::string, std::map<std::size_t, std::string>> sets;
  for (const PscadChannel& c : channels) {
    std::smatch match;
    if (!std::regex_match(c.name, match, of_phase)) continue;
    if (const auto phase = phase_of(match[2].str()))
      sets[c.group + "." + match[1].str() + (phase->between ? "-" : "")].emplace(phase->number, c.name);
  }
  for (const auto& [key, phases] : sets)
    if (phases.size() == 3) return fmt::format("{}, {}, {}", phases.at(0), phases.at(1), phases.at(2));
  return "";
}

/// Returns the headings: the time, then the channels. Names that occur in several groups become "GROUP.NAME".
std::vector<Heading> headings_of(const std::vector<PscadChannel>& channels) {
  std::map<std::string, int> seen;
  for (const PscadChannel& c : channels) ++seen[c.name];
  std::vector<Heading> headings{{"t_s", ColumnMeaning{Quantity::time, Unit::second, false, {}, false}}};
  for (const PscadChannel& c : channels) {
    const std::string name = seen[c.name] > 1 && !c.group.empty() ? c.group + "." + c.name : c.name;
    auto meaning = column_meaning(name, c.unit);
    // "V_dc" with a unit in the .inf is not V: the ending of a name is a unit only in text columns.
    if (meaning && !meaning->unit && !c.unit.empty()) meaning.reset();
    headings.push_back({name, meaning, c.unit});
  }
  return headings;
}

/// Checks that all parts have the same times and the same number of rows as the first part.
void check_rows(const std::vector<OutFile>& parts, Problems& problems) {
  for (std::size_t k = 1; k < parts.size(); ++k) {
    const OutFile &one = parts.front(), &other = parts[k];
    const std::size_t rows = std::min(one.t.size(), other.t.size());
    // The tolerance is 1 % of the sample interval, because a copy may have fewer digits.
    const double near = rows > 1 ? 0.01 * (one.t[rows - 1] - one.t[0]) / static_cast<double>(rows - 1) : 0;
    const auto same = [near](double a, double b) { return std::abs(a - b) <= near; };
    const auto differs =
        static_cast<std::size_t>(std::ranges::mismatch(one.t, other.t, same).in1 - one.t.begin());
    if (differs < rows)
      problems.add(fmt::format("t = {:.9g} s", other.t[differs]),
                   fmt::format("{}:{}", other.file, other.lines[differs]),
                   fmt::format("{}:{} has {:.9g} s", one.file, one.lines[differs], one.t[differs]),
                   "give the files of one run");
    else if (one.t.size() != other.t.size())
      problems.add(fmt::format("{} rows", other.t.size()),
                   fmt::format("{}:{}", other.file, other.lines.empty() ? 1 : other.lines.back()),
                   fmt::format("{} has {}", one.file, one.t.size()),
                   "give the files of one run that has ended");
  }
}

}  // namespace

Record read_pscad_record(const SourceFile& source, const RecordBase& base, const ReadOptions& options) {
  const std::string inf = source.config.string();
  Problems problems;
  std::string bytes = read_bytes(source.config);
  const std::vector<PscadChannel> channels = parse_inf(bytes, inf, problems);
  problems.raise();
  RawRecord raw;
  raw.about.name = source.path.filename().string();
  raw.about.format = "PSCAD";
  std::vector<Heading> headings = headings_of(channels);
  const auto chosen = choose_columns(headings, options, base, inf, raw.about, problems);
  if (const std::string phases = three_phases(channels); !phases.empty() && !problems.empty())
    problems.add(
        "instantaneous three-phase channels " + phases, inf,
        "a comparison needs RMS quantities or phasors, not waveforms",
        "connect output channels to PSCAD's Three Phase RMS Voltmeter (V), Real/Reactive Power Meter (P, Q) and "
        "Phase Locked Loop (frequency or angle), and export these");
  problems.raise();
  for (const std::size_t i : chosen) raw.columns.push_back({headings[i].name, *headings[i].meaning, {}});
  std::vector<OutFile> parts;
  for (const PscadChannel& c : channels) {
    const std::size_t at = (c.number - 1) / kChannelsPerPart;
    for (; parts.size() <= at;) parts.push_back({pscad_part(source.config, parts.size() + 1).string()});
    parts[at].width = (c.number - 1) % kChannelsPerPart + 2;
  }
  RawColumn* time = nullptr;
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    if (chosen[c] == 0) {
      time = &raw.columns[c];
      continue;
    }
    const std::size_t number = channels[chosen[c] - 1].number - 1;
    parts[number / kChannelsPerPart].chosen.emplace_back(number % kChannelsPerPart + 1, &raw.columns[c]);
  }
  std::string hashes = sha256(bytes);
  for (OutFile& part : parts) {
    try {
      bytes = read_bytes(part.file);
    } catch (const InputError&) {
      problems.add("no file", part.file, fmt::format("{} lists {} channels", inf, channels.size()),
                   "copy all .out files of the run beside the .inf");
      continue;
    }
    hashes += sha256(bytes);
    if (part.width == 0) continue;  // contains no listed channel
    OutReader(part, bytes, options, problems).read();
  }
  if (problems.empty()) {
    std::erase_if(parts, [](const OutFile& part) { return part.width == 0; });
    check_rows(parts, problems);
  }
  problems.raise();
  const OutFile& first = parts.front();
  time->values = first.t;
  SampleFaults faults([&](std::size_t from, std::size_t to) {
    return from == to ? fmt::format("{}:{}", first.file, first.lines[from])
                      : fmt::format("{}:{}-{}", first.file, first.lines[from], first.lines[to]);
  });
  Record record = build_record(std::move(raw), base, options, std::move(faults), std::move(problems), inf);
  record.sha256 = sha256(hashes);
  return record;
}

}  // namespace swingbank::validate::record
