// Reader of text columns: separators, header dialects, numbers and stamps.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/encoding.hpp"
#include "base/sha256.hpp"
#include "validate/record/detail/build.hpp"
#include "validate/record/detail/cells.hpp"
#include "validate/record/detail/playback.hpp"
#include "validate/record/detail/stamp.hpp"
#include "validate/record/detail/text.hpp"

namespace swingbank::validate::record {
namespace {

/// Exception of a reader that read dates with the month first, and found one for which this is impossible.
struct DayFirst {};

class CsvReader {
 public:
  CsvReader(std::string_view text, std::string name, const RecordBase& base, const ReadOptions& options,
            bool day_first = false)
      : day_first_(day_first),
        text_(text),
        ends_with_line_(text.ends_with('\n') || text.ends_with('\r')),
        name_(std::move(name)),
        base_(base),
        options_(options) {}

  Record read() {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);  // byte order mark of spreadsheet programs
    top_ = find_top(text_, options_.columns);
    read_header();
    RawRecord raw;
    raw.about.name = name_;
    const std::string at = header_.size() == 1
                               ? fmt::format("{}:{}", name_, header_lines_.front())
                               : fmt::format("{}:{}-{}", name_, header_lines_.front(), header_lines_.back());
    headings();
    refuse_tall(at);
    one_time(raw.about);
    chosen_ = choose_columns(headings_, options_, base_, at, raw.about, problems_);
    for (const auto i : chosen_)
      if (headings_[i].meaning->quantity == Quantity::time && stamped(i))
        headings_[i].meaning->unit = Unit::stamp;
    problems_.raise();  // without columns no row can be interpreted
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
      line = take_line(text_);
      ++number_;
      if (const auto content = unquoted(line); !content.empty() && content.front() != '#') return true;
    }
    return false;
  }

  /// Returns whether a line contains values: its first cell is a number or a stamp, or most cells are
  /// numbers.
  [[nodiscard]] bool is_data(const Cells& cells) const {
    if (parse_number(cells[0], top_.separator).ok || parse_stamp(cells[0])) return true;
    const auto numbers = std::ranges::count_if(
        cells, [&](auto c) { return parse_number(c, top_.separator).ok || says_missing(c); });
    const auto empty = std::ranges::count_if(cells, [](auto c) { return c.empty(); });
    return 2 * (numbers - empty) > static_cast<std::ptrdiff_t>(cells.size()) - empty;
  }

  /// Returns whether a line before the heading may belong to it: names of stations or phasors, no numbers.
  [[nodiscard]] bool belongs_to_header(const Cells& cells) const {
    constexpr int kLinesAbove = 5;
    return top_.line + 1 - number_ <= kLinesAbove && cells.size() > 1 &&
           std::ranges::none_of(cells, [&](auto c) { return parse_number(c, top_.separator).ok; });
  }

  /// Reads the heading and the lines around it, at most 6, up to the first values.
  void read_header() {
    std::string_view line;
    while (next(line)) {
      const Cells cells = split(line, top_.separator);
      if (number_ <= top_.line && !belongs_to_header(cells)) continue;
      const bool data = is_data(cells);
      if (data && header_.empty() && by_number()) {
        header_.emplace_back(cells.size());  // empty headings: the column map counts the columns
        header_lines_.push_back(number_);
      }
      if (data && header_.empty())
        problems_.add("no header line", fmt::format("{}:{}", name_, number_), "values come first",
                      "give a first line such as t_s,V_pu,theta_rad,P_pu,Q_pu, or name the columns: "
                      "--columns \"t=#1 [s],V=#2 [pu],…\"");
      problems_.raise();
      if (data || header_.size() == 6) {
        pending_ = cells;
        break;
      }
      header_.push_back(cells);
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

  /// Returns the header line with the most cells that are units (at least two), if any.
  [[nodiscard]] std::optional<std::size_t> unit_line() const {
    std::optional<std::size_t> best;
    std::size_t most = 1;
    for (std::size_t k = 1; k < header_.size(); ++k) {
      const auto n = static_cast<std::size_t>(std::ranges::count_if(header_[k], is_unit));
      if (n > most) most = n, best = k;
    }
    return best;
  }

  /// Returns the header line that names the most quantities; a quantity with a unit counts three times.
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

  /// Returns the line of station names: a line above the quantities with at most a third as many names as
  /// columns. An empty cell repeats the name before it.
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

  /// Returns whether the column map refers to columns by number only.
  [[nodiscard]] bool by_number() const {
    return !options_.columns.empty() && std::ranges::all_of(options_.columns, [](const auto& entry) {
      return entry.second.starts_with('#') || entry.second.starts_with("-#");
    });
  }

  /// Refuses a table with one measurement per line: a name, a time, a value.
  void refuse_tall(const std::string& where) {
    constexpr std::string_view kNames =
        "id name tag tagname point pointid pointtag pointname signal signalid signalname signaltag channel channelname "
        "measurement measurementid variable parameter quantity sensor attribute device key series metric";
    constexpr std::string_view kValues = "value values val reading measurement data wert valeur valor valore";
    std::string name, value;
    for (const Heading& h : headings_) {
      if (h.meaning && h.meaning->quantity != Quantity::time) return;
      const std::string word = normalised(h.name);
      if (name.empty() && is_word_of(word, kNames))
        name = h.name;
      else if (value.empty() && is_word_of(word, kValues))
        value = h.name;
    }
    if (name.empty() || value.empty() || !options_.columns.empty()) return;
    problems_.add("one measurement per line (long format)", where,
                  fmt::format("'{}' is the name of the quantity, '{}' its value", name, value),
                  "export a column for each quantity and a line for each time (a pivot table)");
    problems_.raise();
  }

  /// Keeps the first of several time columns. "SOC" is read as a time only if the file has FRACSEC or no
  /// other time column, because it may be a state of charge. Finds the column FRACSEC, the fraction of the
  /// second according to C37.118.
  void one_time(Record& about) {
    std::vector<std::size_t> times;
    for (std::size_t i = 0; i < headings_.size(); ++i) {
      const auto& [name, meaning, unit] = headings_[i];
      const std::string_view word = std::string_view(name).substr(0, name.find_first_of("([_"));
      if (is_word_of(normalised(word), "fracsec fracsecond fractionofsecond fractionofseconds fracseconds"))
        fraction_ = i;
      if (meaning && meaning->quantity == Quantity::time && meaning->terminal.empty()) times.push_back(i);
    }
    if (times.size() < 2 || options_.columns.contains("t")) return;
    const auto is_charge = [&](std::size_t i) {
      return !fraction_ && normalised(headings_[i].name) == "soc";
    };
    const auto first = std::ranges::find_if_not(times, is_charge);
    const std::size_t chosen = first == times.end() ? times.front() : *first;
    for (const std::size_t i : times) {
      if (i == chosen) continue;
      headings_[i].meaning.reset();
      if (!is_charge(i))
        about.notes.push_back(fmt::format(
            "Of the time columns '{}' and '{}', the first is read; choose with --columns \"t=…\".",
            headings_[chosen].name, headings_[i].name));
    }
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
      if (m && m->quantity == Quantity::time && stamped(i)) m->unit = Unit::stamp;
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
    cells_ = split(line, top_.separator);
    return true;
  }

  void row(RawRecord& raw, SampleFaults& faults) {
    const std::size_t sample = lines_.size();
    lines_.push_back(number_);
    if (cells_.size() == width_ + 1 && cells_.back().empty()) cells_.pop_back();  // separator at the end
    const bool ragged = cells_.size() != width_;
    // Without a line end, the last number may be cut off.
    if ((ragged && cells_.size() < width_ && ends()) || (text_.empty() && !ends_with_line_)) {
      raw.about.notes.push_back(fmt::format(
          "The last line ({}:{}) is {} and was ignored.", name_, number_,
          ragged ? "truncated" : "without a line end, so that its last number may be truncated,"));
      lines_.pop_back();
      return;
    }
    if (ragged)
      faults.add("line", fmt::format("{} values", cells_.size()), sample,
                 fmt::format("the header has {} columns", width_),
                 fmt::format("give {} values, or remove the line", width_));
    for (std::size_t c = 0; c < raw.columns.size(); ++c) {
      RawColumn& column = raw.columns[c];
      double v = kNoValue;
      if (!ragged)
        v = column.meaning.unit == Unit::stamp ? stamp(column, cells_[chosen_[c]], sample, raw, faults)
                                               : value(column, cells_[chosen_[c]], sample, faults);
      column.values.push_back(v);
    }
    if (!fraction_) return;
    const double part = ragged ? kNoValue : parse_number(cells_[*fraction_], top_.separator).value;
    if (!ragged && !std::isfinite(part))
      faults.add(headings_[*fraction_].name, fmt::format("'{}'", cells_[*fraction_]), sample,
                 "it is not a number", "export it again");
    fractions_.push_back(part);
  }

  /// Returns whether only blank lines remain.
  [[nodiscard]] bool ends() const {
    return text_.find_first_not_of(" \t\r\n\"\x1a") == std::string_view::npos;
  }

  double stamp(const RawColumn& column, std::string_view cell, std::size_t sample, RawRecord& raw,
               SampleFaults& faults) {
    const auto s = parse_stamp(cell, day_first_);
    if (s && s->day_first && !day_first_) throw DayFirst{};
    if (!s) {
      faults.add(column.name, fmt::format("{} = '{}'", column.name, cell), sample,
                 "it is not a time stamp, unlike the rows before",
                 "end the record before it, or export it again");
      return kNoValue;
    }
    if (!first_) {
      first_ = s;
      raw.about.start = cell;
    }
    resolution_ = std::min(resolution_, s->resolution);
    // Stamps without hours begin at zero again after each full hour.
    if (s->in_hour && s->second < last_in_hour_ - 1800) hours_ += 3600;
    last_in_hour_ = s->in_hour ? s->second : 0;
    return hours_ + static_cast<double>(s->day - first_->day) * 86400 + (s->second - first_->second);
  }

  double value(const RawColumn& column, std::string_view cell, std::size_t sample, SampleFaults& faults) {
    const char* const mend = "fill it at the source, end the record before it, or export it again";
    const Number n = parse_number(cell, top_.separator);
    commas_ = commas_ || (n.ok && n.comma);
    points_ = points_ || (n.ok && n.point);
    const auto what = [&] { return fmt::format("{} = '{}'", column.name, cell); };
    const bool time = column.meaning.quantity == Quantity::time;
    if (says_missing(cell) && !time)
      faults.lose(column.name, what(), sample, "the value is missing", mend);
    else if (says_missing(cell))
      faults.add(column.name, what(), sample, "the value is missing", mend);
    else if (n.ambiguous)
      faults.add(column.name, what(), sample, "the comma may be a thousands separator or a decimal comma",
                 "export without thousands separators, or with semicolons between the columns");
    else if (!n.ok && is_word(cell) && !time)
      take_word(column, cell, sample, faults);
    else if (!n.ok)
      faults.add(column.name, what(), sample, "it is not a number", mend);
    else if (!std::isfinite(n.value))
      faults.add(column.name, what(), sample, "the value is not finite", mend);
    else if (!time && is_code(n.value))
      faults.lose(column.name, what(), sample, "instruments write this code for a missing value", mend);
    else {
      if (time && n.decimals > 0) resolution_ = std::min(resolution_, std::pow(10.0, -n.decimals));
      return n.value;
    }
    return kNoValue;
  }

  /// Treats a word in place of a number as a missing value, and counts it for a note.
  void take_word(const RawColumn& column, std::string_view cell, std::size_t sample, SampleFaults& faults) {
    faults.lose(column.name, fmt::format("{} = '{}'", column.name, cell), sample, "it is not a number",
                "fill it at the source, end the record before it, or export it again");
    if (words_.try_emplace(std::string(cell), 0).first->second++ == 0) word_at_.emplace(cell, lines_[sample]);
  }

  /// Computes UTC of the first stamp if its zone is known.
  void finish_beginning(RawRecord& raw) const {
    if (!first_ || first_->day == 0) return;
    const std::string heading = normalised(time_column(raw).name);
    if (first_->zoned || heading.find("utc") != std::string::npos || heading.find("gmt") != std::string::npos)
      raw.about.epoch = static_cast<double>(first_->day) * 86400 + first_->second;
  }

  void finish_times(RawRecord& raw) {
    RawColumn* time = &time_column(raw);
    const auto unit = time->meaning.unit;
    if (std::isfinite(resolution_))
      raw.time_resolution = resolution_;
    else if (std::ranges::any_of(time->values, [](double v) { return v != std::round(v); }))
      raw.time_resolution = 0;
    else if (unit == Unit::millisecond || unit == Unit::microsecond || unit == Unit::nanosecond ||
             (!unit && !time->values.empty() && time->values.front() > 5e11))
      raw.time_resolution = 1;  // times in whole milliseconds are rounded too
    if (fraction_) add_fractions(time->values, raw);
    for (const auto& [word, count] : words_)
      raw.about.notes.push_back(fmt::format("{} {} a number ('{}', {} {}:{}); treated as missing.", count,
                                            count == 1 ? "cell is not" : "cells are not", word,
                                            count == 1 ? "at" : "first at", name_, word_at_.at(word)));
  }

  /// Adds the fractions of a second to the times. Their unit is that of the heading, or seconds if all are
  /// below 1. Otherwise they are counts of a clock, whose rate is inferred from the largest value.
  void add_fractions(std::vector<double>& t, RawRecord& raw) {
    const std::string name = headings_[*fraction_].name;
    double most = 0;
    for (const double v : fractions_)
      if (std::isfinite(v)) most = std::max(most, v);
    const auto named_unit = unit_in(Quantity::time, name, headings_[*fraction_].unit);
    double scale = named_unit ? to_record_units({Quantity::time, named_unit, false, {}, false}, 1, base_) : 0;
    if (!named_unit && most < 1) scale = 1;
    for (const double clock : {1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 16777216.0, 1e8, 1e9})
      if (scale == 0 && most < clock && most >= 0.8 * clock) scale = 1 / clock;
    if (scale == 0 || most * scale > 1)
      problems_.add(fmt::format("no unit for column '{}'", name), name_,
                    fmt::format("values of up to {:g}: the number of counts per second is unknown", most),
                    "name its unit, such as FRACSEC_us, or give the times in one column");
    if (most >= 1 && scale > 0) raw.time_resolution = scale;
    for (std::size_t k = 0; k < t.size() && k < fractions_.size(); ++k) t[k] += scale * fractions_[k];
  }

  bool day_first_;  ///< order of dates that have two
  std::string_view text_;
  bool ends_with_line_;
  std::string name_;
  RecordBase base_;
  ReadOptions options_;
  Problems problems_;
  TableTop top_;
  std::vector<Cells> header_;
  std::vector<int> header_lines_;
  std::size_t width_ = 0;
  std::vector<Heading> headings_;
  std::vector<std::size_t> chosen_;
  Cells pending_, cells_;  ///< the first line of values, and the current one
  bool started_ = false, commas_ = false, points_ = false;
  std::optional<Stamp> first_;
  double resolution_ =
      std::numeric_limits<double>::infinity();  ///< finest resolution of the times, in their unit
  double hours_ = 0, last_in_hour_ = 0;         ///< [s]; for stamps with minutes and seconds only
  std::optional<std::size_t> fraction_;         ///< column of FRACSEC
  std::vector<double> fractions_;
  std::map<std::string, int> words_, word_at_;  ///< words in place of numbers: count, and first line
  std::vector<int> lines_;                      ///< file line of each sample
  int number_ = 0;
};

/// Reads a table. One date can show the order of day and month in all dates of the file.
Record read_csv(std::string_view text, const std::string& name, const RecordBase& base,
                const ReadOptions& options) {
  try {
    return CsvReader(text, name, base, options).read();
  } catch (const DayFirst&) {
    return CsvReader(text, name, base, options, true).read();
  }
}

}  // namespace

Record parse_record(std::string_view text, const std::string& name, const RecordBase& base,
                    const ReadOptions& options) {
  refuse_binary(text, name);
  std::vector<std::string> notes;
  const std::string known = as_utf8(text, notes);
  const bool playback = is_powerworld(known) || is_plb(name);
  Record record =
      playback ? playback_record(known, name, base, options) : read_csv(known, name, base, options);
  record.notes.insert(record.notes.begin(), notes.begin(), notes.end());
  record.sha256 = sha256(text);
  return record;
}

}  // namespace swingbank::validate::record
