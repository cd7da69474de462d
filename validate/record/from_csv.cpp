// Records as text in columns: separators, header dialects, numbers and stamps.
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "validate/record/detail/build.hpp"
#include "validate/record/detail/playback.hpp"
#include "validate/record/detail/text.hpp"
#include "validate/record/detail/times.hpp"

namespace swingbank::validate::record {
namespace {

using Cells = std::vector<std::string_view>;

std::string_view unquoted(std::string_view s) {
  constexpr std::string_view blank = " \t\r\"";
  const auto first = s.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(blank) - first + 1);
}

/// Cells of a line; a separator between quotes is text, and blanks separate in any number.
Cells split(std::string_view line, char separator) {
  Cells cells;
  if (separator == ' ') {
    for (std::string_view rest = unquoted(line); !rest.empty(); rest = unquoted(rest)) {
      const auto end = std::min(rest.find_first_of(" \t"), rest.size());
      cells.push_back(unquoted(rest.substr(0, end)));
      rest.remove_prefix(end);
    }
    return cells;
  }
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t at = 0; at <= line.size(); ++at) {
    if (at < line.size() && line[at] == '"') quoted = !quoted;
    if (at < line.size() && (quoted || line[at] != separator)) continue;
    cells.push_back(unquoted(line.substr(begin, at - begin)));
    begin = at + 1;
  }
  return cells;
}

/// What stands most often on the header line.
char separator_of(std::string_view line) {
  char best = ',';
  std::size_t most = split(line, best).size();
  for (const char c : {';', '\t'})
    if (const auto n = split(line, c).size(); n > most) best = c, most = n;
  return best;
}

/// Ways to say that there is no value.
bool says_missing(std::string_view cell) {
  const std::string word = normalised(cell);
  return cell.empty() || word == "nan" || word == "na" || word == "null" || word == "none" || word == "bad" ||
         word == "missing" || cell == "-" || cell == "--";
}

/// Codes that instruments write instead of a value.
bool is_code(double v) {
  for (const double code : {-999.0, 9999.0, 99999.0, 999999.0})
    if (std::abs(v) == std::abs(code) && (v > 0 || code == -999.0 || v < -999.0)) return true;
  return std::abs(v) >= 1e30;
}

struct Number {
  double value = kNoValue;
  int decimals = 0;
  bool ok = false, comma = false, point = false;
};

/// A number; decimal commas where commas do not separate.
Number parse_number(std::string_view cell, char separator) {
  Number n;
  std::string text;
  const auto comma = cell.find(',');
  if (separator != ',' && comma != std::string_view::npos && cell.find('.') == std::string_view::npos) {
    text = cell;
    text[comma] = '.';
    cell = text;
    n.comma = true;
  }
  if (cell.starts_with('+') && cell.size() > 1 && cell[1] != '-') cell.remove_prefix(1);
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), n.value);
  n.ok = !cell.empty() && error == std::errc{} && end == cell.data() + cell.size();
  if (const auto point = cell.find('.'); point != std::string_view::npos) {
    n.point = !n.comma;
    n.decimals = static_cast<int>(std::min(cell.find_first_of("eE"), cell.size()) - point - 1);
    if (cell.find_first_of("eE") != std::string_view::npos) n.decimals = 0;
  }
  if (!n.ok) n.value = kNoValue;
  return n;
}

/// Do blanks separate the values? So they do where three lines are numbers that nothing else separates.
bool by_blanks(std::string_view text) {
  int found = 0;
  for (int n = 0; n < 50 && !text.empty(); ++n) {
    const auto end = text.find('\n');
    const std::string_view line = unquoted(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.find_first_of(",;\t") != std::string_view::npos) continue;
    const Cells cells = split(line, ' ');
    if (cells.size() >= 3 && std::ranges::all_of(cells, [](auto c) { return parse_number(c, ' ').ok; }) &&
        ++found == 3)
      return true;
  }
  return false;
}

class CsvReader {
 public:
  CsvReader(std::string_view text, std::string name, const RecordBase& base, const ReadOptions& options)
      : text_(text), name_(std::move(name)), base_(base), options_(options) {}

  Record read() {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);  // byte order mark of spreadsheet programs
    blanks_ = by_blanks(text_);
    read_header();
    RawRecord raw;
    raw.about.name = name_;
    const std::string at = header_.size() == 1
                               ? fmt::format("{}:{}", name_, header_lines_.front())
                               : fmt::format("{}:{}-{}", name_, header_lines_.front(), header_lines_.back());
    headings();
    for (auto& h : headings_)
      if (h.meaning && h.meaning->quantity == Quantity::time && !h.meaning->unit) take_seconds(h, raw.about);
    chosen_ = choose_columns(headings_, options_, base_, at, raw.about, problems_);
    for (const auto i : chosen_)
      if (headings_[i].meaning->quantity == Quantity::time && stamped(i))
        headings_[i].meaning->unit = Unit::stamp;
    problems_.raise();  // without columns no row means anything
    for (const auto i : chosen_) raw.columns.push_back({headings_[i].name, *headings_[i].meaning, {}});
    SampleFaults faults([this](std::size_t first, std::size_t last) {
      return first == last ? fmt::format("{}:{}", name_, lines_[first])
                           : fmt::format("{}:{}-{}", name_, lines_[first], lines_[last]);
    });
    while (next_row()) row(raw, faults);
    finish_times(raw);
    finish_beginning(raw);
    if (commas_ && points_)
      problems_.add("decimal commas and decimal points", name_, "one file uses both",
                    "export it with points");
    return build_record(std::move(raw), base_, options_, std::move(faults), std::move(problems_), name_);
  }

 private:
  bool next(std::string_view& line) {
    while (!text_.empty()) {
      const auto end = text_.find('\n');
      line = text_.substr(0, end);
      text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
      ++number_;
      if (const auto content = unquoted(line); !content.empty() && content.front() != '#') return true;
    }
    return false;
  }

  /// A line of values: its first cell is a number or a stamp, or most cells are numbers.
  [[nodiscard]] bool is_data(const Cells& cells) const {
    if (parse_number(cells[0], separator_).ok || parse_stamp(cells[0])) return true;
    const auto numbers = std::ranges::count_if(
        cells, [&](auto c) { return parse_number(c, separator_).ok || says_missing(c); });
    const auto empty = std::ranges::count_if(cells, [](auto c) { return c.empty(); });
    return 2 * (numbers - empty) > static_cast<std::ptrdiff_t>(cells.size()) - empty;
  }

  /// Lines before the first values, at most 6; a line of a single cell (a title) is passed over.
  void read_header() {
    std::string_view line;
    while (next(line)) {
      if (header_.empty()) separator_ = blanks_ ? ' ' : separator_of(line);
      const Cells cells = split(line, separator_);
      const bool data = is_data(cells);
      if (data && header_.empty() && by_number()) {
        header_.emplace_back(cells.size());  // headings without names: the map counts them
        header_lines_.push_back(number_);
      }
      if (data && header_.empty())
        problems_.add("no header line", fmt::format("{}:{}", name_, number_), "values come first",
                      "give a first line such as t_s,V_pu,theta_rad,P_pu,Q_pu, or say what the columns are: "
                      "--columns \"t=#1 [s],V=#2 [pu],…\"");
      problems_.raise();
      if (data || header_.size() == 6) {
        pending_ = cells;
        break;
      }
      if (header_.size() == 1 && header_.front().size() == 1) header_.clear(), header_lines_.clear();
      if (header_.empty()) separator_ = blanks_ ? ' ' : separator_of(line);
      header_.push_back(split(line, separator_));
      header_lines_.push_back(number_);
    }
    if (header_.empty())
      problems_.add("empty record", name_, "there is no header line",
                    "give a CSV file with a header such as t_s,V_pu,theta_rad,P_pu,Q_pu");
    problems_.raise();
    for (const auto& h : header_) width_ = std::max(width_, h.size());
  }

  [[nodiscard]] std::string_view header_cell(std::size_t line, std::size_t column) const {
    return column < header_[line].size() ? header_[line][column] : std::string_view{};
  }

  /// Of several header lines, the one whose cells are units most often (at least twice), if any.
  [[nodiscard]] std::optional<std::size_t> unit_line() const {
    std::optional<std::size_t> best;
    std::size_t most = 1;
    for (std::size_t k = 1; k < header_.size(); ++k) {
      const auto n = static_cast<std::size_t>(std::ranges::count_if(header_[k], is_unit));
      if (n > most) most = n, best = k;
    }
    return best;
  }

  /// The header line that names the most quantities with their units.
  [[nodiscard]] std::size_t quantity_line(std::optional<std::size_t> units) const {
    std::size_t best = 0, most = 0;
    for (std::size_t k = 0; k < header_.size(); ++k) {
      if (k == units) continue;
      std::size_t n = 0;
      for (std::size_t i = 0; i < width_; ++i) {
        const auto m = column_meaning(header_cell(k, i), units ? header_cell(*units, i) : std::string_view{});
        n += m ? (m->unit ? 3 : 1) : 0;
      }
      if (n > most) most = n, best = k;
    }
    return best;
  }

  /// Stations: another line above with fewer names than columns, each for several columns. An empty cell
  /// goes on with the name before it.
  [[nodiscard]] std::optional<std::size_t> station_line(std::size_t quantities,
                                                        std::optional<std::size_t> units) const {
    for (std::size_t k = 0; k < quantities; ++k) {
      if (k == units) continue;
      std::vector<std::string_view> names;
      for (std::size_t i = 1; i < header_[k].size(); ++i)
        if (!header_[k][i].empty() && std::ranges::find(names, header_[k][i]) == names.end())
          names.push_back(header_[k][i]);
      if (!names.empty() && 3 * names.size() <= width_ - 1) return k;
    }
    return std::nullopt;
  }

  /// Does the map of columns count them?
  [[nodiscard]] bool by_number() const {
    return !options_.columns.empty() && std::ranges::all_of(options_.columns, [](const auto& entry) {
      return entry.second.starts_with('#') || entry.second.starts_with("-#");
    });
  }

  /// "Time" without a unit, and with numbers.
  static void take_seconds(Heading& h, Record& about) {
    h.meaning->unit = Unit::second;
    about.notes.push_back(fmt::format("The column '{}' names no unit: it was taken for seconds.", h.name));
  }

  void headings() {
    const auto units = unit_line();
    const std::size_t quantities = quantity_line(units);
    const auto stations = station_line(quantities, units);
    std::string_view station;
    for (std::size_t i = 0; i < width_; ++i) {
      const std::string_view cell = header_cell(quantities, i);
      auto m = column_meaning(cell, units ? header_cell(*units, i) : std::string_view{});
      if (stations && !header_cell(*stations, i).empty()) station = header_cell(*stations, i);
      if (m && m->quantity == Quantity::time && !m->unit && stamped(i)) m->unit = Unit::stamp;
      if (m && stations && m->terminal.empty() && m->quantity != Quantity::time) m->terminal = station;
      headings_.push_back(
          {std::string(cell), m, std::string(units ? header_cell(*units, i) : std::string_view{})});
    }
  }

  [[nodiscard]] bool stamped(std::size_t column) const {
    return column < pending_.size() && parse_stamp(pending_[column]).has_value();
  }

  bool next_row() {
    if (!pending_.empty() && !std::exchange(started_, true)) {
      cells_ = std::move(pending_);
      return true;
    }
    std::string_view line;
    if (!next(line)) return false;
    cells_ = split(line, separator_);
    return true;
  }

  void row(RawRecord& raw, SampleFaults& faults) {
    const std::size_t sample = lines_.size();
    lines_.push_back(number_);
    if (cells_.size() == width_ + 1 && cells_.back().empty()) cells_.pop_back();  // separator at the end
    const bool ragged = cells_.size() != width_;
    if (ragged && cells_.size() < width_ && ends()) {
      raw.about.notes.push_back(
          fmt::format("The last line ({}:{}) breaks off and was left out.", name_, number_));
      lines_.pop_back();
      return;
    }
    if (ragged)
      faults.add("line", fmt::format("{} values", cells_.size()), sample,
                 fmt::format("the header has {} columns", width_), "complete the line or remove it");
    for (std::size_t c = 0; c < raw.columns.size(); ++c) {
      RawColumn& column = raw.columns[c];
      double v = kNoValue;
      if (!ragged)
        v = column.meaning.unit == Unit::stamp ? stamp(column, cells_[chosen_[c]], sample, raw, faults)
                                               : value(column, cells_[chosen_[c]], sample, faults);
      column.values.push_back(v);
    }
  }

  /// Is nothing but blank lines left?
  [[nodiscard]] bool ends() const {
    return text_.find_first_not_of(" \t\r\n\"\x1a") == std::string_view::npos;
  }

  double stamp(const RawColumn& column, std::string_view cell, std::size_t sample, RawRecord& raw,
               SampleFaults& faults) {
    const auto s = parse_stamp(cell);
    if (!s) {
      faults.add(column.name, fmt::format("{} = '{}'", column.name, cell), sample,
                 "this is no time stamp like the ones before",
                 "cut the record before it, or export it again");
      return kNoValue;
    }
    if (!first_) {
      first_ = s;
      raw.about.start = cell;
    }
    decimals_ = std::max(decimals_, s->decimals);
    return static_cast<double>(s->day - first_->day) * 86400 + (s->second - first_->second);
  }

  double value(const RawColumn& column, std::string_view cell, std::size_t sample, SampleFaults& faults) {
    const char* const mend = "fill it at the source, cut the record before it, or export it again";
    const Number n = parse_number(cell, separator_);
    commas_ = commas_ || n.comma;
    points_ = points_ || n.point;
    const auto what = [&] { return fmt::format("{} = '{}'", column.name, cell); };
    const bool time = column.meaning.quantity == Quantity::time;
    if (says_missing(cell) && !time)
      faults.lose(column.name, what(), sample, "the value is missing", mend);
    else if (says_missing(cell))
      faults.add(column.name, what(), sample, "the value is missing", mend);
    else if (!n.ok)
      faults.add(column.name, what(), sample, "this is no number", mend);
    else if (!std::isfinite(n.value))
      faults.add(column.name, what(), sample, "the value is not finite", mend);
    else if (!time && is_code(n.value))
      faults.lose(column.name, what(), sample, "instruments write this where a value is missing", mend);
    else {
      if (time) decimals_ = std::max(decimals_, n.decimals);
      return n.value;
    }
    return kNoValue;
  }

  /// UTC of the first stamp, where its zone is known.
  void finish_beginning(RawRecord& raw) const {
    if (!first_ || first_->day == 0) return;
    const auto time =
        std::ranges::find(raw.columns, Quantity::time, [](const auto& c) { return c.meaning.quantity; });
    const std::string heading = normalised(time->name);
    if (first_->zoned || heading.find("utc") != std::string::npos || heading.find("gmt") != std::string::npos)
      raw.about.epoch = static_cast<double>(first_->day) * 86400 + first_->second;
  }

  void finish_times(RawRecord& raw) const {
    if (decimals_ > 0 && decimals_ < 9) raw.time_resolution = std::pow(10.0, -decimals_);
    for (const auto& c : raw.columns)  // whole milliseconds are a rounding too
      if (decimals_ == 0 && c.meaning.unit == Unit::millisecond) raw.time_resolution = 1;
  }

  std::string_view text_;
  std::string name_;
  RecordBase base_;
  ReadOptions options_;
  Problems problems_;
  char separator_ = ',';
  std::vector<Cells> header_;
  std::vector<int> header_lines_;
  std::size_t width_ = 0;
  std::vector<Heading> headings_;
  std::vector<std::size_t> chosen_;
  Cells pending_, cells_;  ///< the first line of values, and the present one
  bool started_ = false, commas_ = false, points_ = false, blanks_ = false;
  std::optional<Stamp> first_;
  int decimals_ = 0;
  std::vector<int> lines_;  ///< file line of each sample
  int number_ = 0;
};

}  // namespace

Record parse_record(std::string_view text, const std::string& name, const RecordBase& base,
                    const ReadOptions& options) {
  refuse_binary(text, name);
  std::vector<std::string> notes;
  const std::string known = as_utf8(text, notes);
  const bool playback = is_powerworld(known) || is_plb(name);
  Record record =
      playback ? playback_record(known, name, base, options) : CsvReader(known, name, base, options).read();
  record.notes.insert(record.notes.begin(), notes.begin(), notes.end());
  record.hash = XXH64(text.data(), text.size(), 0);
  return record;
}

}  // namespace swingbank::validate::record
