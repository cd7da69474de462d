#include "validate/record.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>
#include <utility>

namespace swingbank::validate {
namespace {

enum class Quantity { time, V, theta, f, P, Q, speed, Efd, Ifd };
constexpr int kQuantities = 9;
constexpr Quantity kRequired[] = {Quantity::time, Quantity::V, Quantity::theta, Quantity::P, Quantity::Q};

/// A column name a record may use; convert() brings its cells to the record's units.
struct Column {
  std::string_view name;
  Quantity quantity;
  enum class Unit { plain, milli, degrees, kilovolt, megawatt, hertz, absolute } unit = Unit::plain;
};
using U = Column::Unit;
constexpr Column kColumns[] = {
    {"t_s", Quantity::time},
    {"time_s", Quantity::time},
    {"t_ms", Quantity::time, U::milli},
    {"V_pu", Quantity::V},
    {"V_kV", Quantity::V, U::kilovolt},
    {"theta_rad", Quantity::theta},
    {"theta_deg", Quantity::theta, U::degrees},
    {"f_pu", Quantity::f, U::absolute},
    {"f_hz", Quantity::f, U::hertz},
    {"P_pu", Quantity::P},
    {"P_MW", Quantity::P, U::megawatt},
    {"Q_pu", Quantity::Q},
    {"Q_Mvar", Quantity::Q, U::megawatt},
    {"omega_pu", Quantity::speed, U::absolute},
    {"speed_pu", Quantity::speed},
    {"Efd_pu", Quantity::Efd},
    {"Ifd_pu", Quantity::Ifd},
};

std::string lower(std::string_view s) {
  std::string r(s);
  std::ranges::transform(r, r.begin(), [](unsigned char c) { return std::tolower(c); });
  return r;
}

std::string_view trim(std::string_view s) {
  constexpr std::string_view blank = " \t\r\"";
  const auto first = s.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(blank) - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t at = 0;;) {
    const auto comma = line.find(',', at);
    cells.push_back(trim(line.substr(at, comma - at)));
    if (comma == std::string_view::npos) return cells;
    at = comma + 1;
  }
}

/// All names of a quantity: "P_pu, P_MW".
std::string names_of(Quantity q) {
  std::string all;
  for (const auto& c : kColumns)
    if (c.quantity == q) all += (all.empty() ? "" : ", ") + std::string(c.name);
  return all;
}

/// The quantity a header names without a unit we know ("P", "P_kW"), if any.
std::optional<Quantity> quantity_of(std::string_view header) {
  const std::string stem = lower(header.substr(0, header.find('_')));
  for (const auto& c : kColumns)
    if (lower(c.name.substr(0, c.name.find('_'))) == stem) return c.quantity;
  return std::nullopt;
}

class Reader {
 public:
  Reader(std::string_view text, std::string name, const RecordBase& base)
      : text_(text), name_(std::move(name)) {
    record_.name = name_;
    record_.base = base;
  }

  Record read() {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);  // byte order mark of spreadsheet programs
    std::string_view line;
    if (!next(line)) {
      problems_.add("empty record", name_, "there is no header line",
                    "give a CSV file with a header such as t_s,V_pu,theta_rad,P_pu,Q_pu");
      problems_.raise();
    }
    header(line);
    problems_.raise();  // without columns no row means anything
    while (next(line)) row(line);
    check_times();
    raise();
    unwrap();
    return std::move(record_);
  }

 private:
  bool next(std::string_view& line) {
    while (!text_.empty()) {
      const auto end = text_.find('\n');
      line = text_.substr(0, end);
      text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
      ++number_;
      if (const auto content = trim(line); !content.empty() && content.front() != '#') return true;
    }
    return false;
  }

  [[nodiscard]] std::string where(int line) const { return fmt::format("{}:{}", name_, line); }

  void header(std::string_view line) {
    if (line.find(',') == std::string_view::npos && line.find(';') != std::string_view::npos)
      problems_.add("semicolons between the columns", where(number_),
                    "a record is comma-separated with decimal points", "export it with commas");
    problems_.raise();
    for (const auto cell : split(line)) name_column(cell);
    for (const auto q : kRequired)
      if (!used_[static_cast<int>(q)])
        problems_.add("no column " + names_of(q), where(number_),
                      "play-in needs time, voltage, angle, P and Q", "add the column, named with its unit");
  }

  void name_column(std::string_view cell) {
    const auto known =
        std::ranges::find_if(kColumns, [&](const Column& c) { return lower(c.name) == lower(cell); });
    columns_.push_back(known == std::end(kColumns) ? nullptr : &*known);
    if (known == std::end(kColumns)) {
      if (const auto q = quantity_of(cell)) {
        used_[static_cast<int>(*q)] = true;  // it is there, if not usable: do not call it missing too
        problems_.add(fmt::format("column '{}'", cell), where(number_), "its unit is missing or not known",
                      "name it one of " + names_of(*q));
      } else {
        record_.ignored.emplace_back(cell);
      }
      return;
    }
    if (std::exchange(used_[static_cast<int>(known->quantity)], true))
      problems_.add(fmt::format("column '{}'", cell), where(number_),
                    "another column gives the same quantity", "leave one of " + names_of(known->quantity));
    if (known->unit == U::kilovolt && !(record_.base.kv > 0))
      problems_.add("column 'V_kV'", where(number_), "the model names no base_kv for records",
                    "add base_kv under [record] in the plant file, or give V_pu");
  }

  void row(std::string_view line) {
    const auto cells = split(line);
    if (cells.size() != columns_.size()) {
      fault(fmt::format("{} values", cells.size()), number_,
            fmt::format("the header has {} columns", columns_.size()), "complete the line or remove it");
      return;
    }
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (columns_[i]) channel(columns_[i]->quantity).push_back(value(*columns_[i], cells[i]));
    lines_.push_back(number_);
  }

  double value(const Column& column, std::string_view cell) {
    double v = std::numeric_limits<double>::quiet_NaN();
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), v);
    if (cell.empty() || error != std::errc{} || end != cell.data() + cell.size())
      fault(fmt::format("{} = '{}'", column.name, cell), number_,
            cell.empty() ? "the value is missing" : "this is no number",
            "cut the record before it, or export it again");
    else if (!std::isfinite(v))
      fault(fmt::format("{} = {}", column.name, cell), number_, "the value is not finite",
            "cut the record before it, or export it again");
    else if (column.quantity == Quantity::V && v < 0)
      fault(fmt::format("{} = {}", column.name, cell), number_, "a magnitude cannot be negative",
            "give V as a magnitude and theta as its angle");
    return convert(column.unit, v);
  }

  [[nodiscard]] double convert(U unit, double v) const {
    switch (unit) {
      case U::plain:
        return v;
      case U::milli:
        return v * 1e-3;
      case U::degrees:
        return v * std::numbers::pi / 180;
      case U::kilovolt:
        return v / record_.base.kv;
      case U::megawatt:
        return v / record_.base.mva;
      case U::hertz:
        return v / record_.base.frequency - 1;
      case U::absolute:
        return v - 1;
    }
    return v;
  }

  std::vector<double>& channel(Quantity q) {
    std::vector<double>* all[kQuantities] = {&record_.t,     &record_.V,   &record_.theta,
                                             &record_.f,     &record_.P,   &record_.Q,
                                             &record_.speed, &record_.Efd, &record_.Ifd};
    return *all[static_cast<int>(q)];
  }

  /// Times must increase by one and the same step: 1 % is what rounding to 0.1 ms leaves at 120 samples/s.
  void check_times() {
    const auto& t = record_.t;
    if (record_.samples() < kFewestSamples) {
      fault(fmt::format("{} samples", record_.samples()), number_,
            fmt::format("a record needs at least {}", kFewestSamples), "give a longer record");
      return;
    }
    std::vector<double> steps(t.size() - 1);
    for (std::size_t i = 0; i + 1 < t.size(); ++i) steps[i] = t[i + 1] - t[i];
    std::vector<double> sorted = steps;
    std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
    const double usual = sorted[sorted.size() / 2];
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (!std::isfinite(steps[i])) continue;  // already reported as a value
      if (!(steps[i] > 0))
        fault(fmt::format("t = {} s after t = {} s", t[i + 1], t[i]), lines_[i + 1],
              steps[i] == 0 ? "the time is repeated" : "time runs backwards",
              "sort the record and remove repeated lines");
      else if (usual > 0 && std::abs(steps[i] - usual) > 0.01 * usual)
        fault(fmt::format("a step of {:.6g} s", steps[i]), lines_[i + 1],
              fmt::format("elsewhere samples are {:.6g} s apart", usual),
              "fill gaps at the source, and give times with at least 5 decimals");
    }
  }

  /// Angles are known up to turns; a continuous one is kept, so that plots and differences make sense.
  void unwrap() {
    constexpr double turn = 2 * std::numbers::pi;
    for (std::size_t i = 1; i < record_.theta.size(); ++i)
      record_.theta[i] -= turn * std::round((record_.theta[i] - record_.theta[i - 1]) / turn);
  }

  void fault(std::string what, int line, std::string why, std::string remedy) {
    if (++faults_ <= kShown) problems_.add(std::move(what), where(line), std::move(why), std::move(remedy));
  }
  void raise() {
    if (faults_ > kShown)
      problems_.add(fmt::format("{} further faults", faults_ - kShown), name_, "the list is cut here",
                    "mend the ones above first");
    problems_.raise();
  }

  static constexpr int kShown = 50;
  std::string_view text_;
  std::string name_;
  Record record_;
  Problems problems_;
  std::vector<const Column*> columns_;
  std::vector<int> lines_;  ///< file line of each sample
  bool used_[kQuantities] = {};
  int number_ = 0, faults_ = 0;
};

}  // namespace

Record parse_record(std::string_view text, const std::string& name, const RecordBase& base) {
  Record record = Reader(text, name, base).read();
  record.hash = XXH64(text.data(), text.size(), 0);
  return record;
}

Record read_record(const std::filesystem::path& file, const RecordBase& base) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf()))
    throw InputError({"no readable record", file.string(), "the file cannot be opened or is empty",
                      "give the path of a CSV record"});
  Record record = parse_record(text.str(), file.string(), base);
  record.name = file.filename().string();
  return record;
}

}  // namespace swingbank::validate
