#include "validate/record/detail/comtrade_cfg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <regex>
#include <string>

#include "base/capitals.hpp"
#include "base/encoding.hpp"
#include "validate/record/detail/text.hpp"

namespace swingbank::validate::record {
namespace {

std::string_view trim(std::string_view s) { return trimmed(s, " \t\r\x1a"); }

class Config {
 public:
  Config(std::string_view text, std::string name, Problems& problems)
      : rest_(text), name_(std::move(name)), problems_(problems) {}

  ComtradeConfig read() {
    if (!station() || !channels()) return std::move(c_);
    rates();
    times();
    if (without_side_)
      c_.about.notes.push_back(
          "Revision 1991 of COMTRADE does not state the side of the instrument transformers: the values were "
          "taken as primary.");
    return std::move(c_);
  }

 private:
  using Fields = std::vector<std::string_view>;

  Fields next() {
    ++number_;
    if (rest_.empty()) {
      if (!ended_) fault("premature end of the configuration", "lines are missing", "export it again");
      ended_ = true;
      return {};
    }
    return comtrade_fields(take_line(rest_));
  }
  void fault(std::string what, std::string why, std::string remedy) {
    if (ended_) return;  // a single message for a truncated file
    problems_.add(std::move(what), fmt::format("{}:{}", name_, number_), std::move(why), std::move(remedy));
  }

  double number(const Fields& fields, std::size_t i, const char* what) {
    const auto v = i < fields.size() ? comtrade_number(fields[i]) : std::nullopt;
    if (!v)
      fault(fmt::format("{} = '{}'", what, i < fields.size() ? fields[i] : ""), "it is not a number",
            "export the configuration again");
    return v.value_or(0);
  }

  bool station() {
    const Fields f = next();
    if (ended_) return false;
    c_.about.station = f[0];
    c_.about.device = f.size() > 1 ? f[1] : "";
    if (f.size() < 3 || f[2].empty()) {
      c_.about.revision = 1991;  // this format has no revision year
      return true;
    }
    const double year = number(f, 2, "revision year");
    // Some recorders write their year of manufacture. Years between 1991 and 2013 are read as 1999, later
    // ones as 2013.
    const bool between = year > 1991 && year<2013, later = year> 2013 && year < 2100;
    c_.about.revision = year == 1991 ? 1991 : between ? 1999 : later || year == 2013 ? 2013 : 0;
    if (c_.about.revision != 0 && c_.about.revision != year)
      c_.about.notes.push_back(fmt::format(
          "The configuration states revision {:.0f}, which does not exist; it was read as revision {}.", year,
          c_.about.revision));
    if (c_.about.revision == 0)
      fault(fmt::format("revision '{}'", f[2]), "the known revisions are 1991, 1999 and 2013",
            "export it as COMTRADE 1999 or 2013");
    return c_.about.revision != 0;
  }

  /// Parses "4A" to 4; negative if invalid.
  static long count(std::string_view field, char letter) {
    if (field.empty() || std::toupper(static_cast<unsigned char>(field.back())) != letter) return -1;
    field.remove_suffix(1);
    long n = -1;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), n);
    return error == std::errc{} && end == field.data() + field.size() && n < 1'000'000 ? n : -1;
  }

  bool channels() {
    const Fields f = next();
    const long analogue = f.size() > 1 ? count(f[1], 'A') : -1, status = f.size() > 2 ? count(f[2], 'D') : -1;
    if (analogue == 0 && status >= 0) {
      fault("no analogue channels", fmt::format("the record holds {} status channels only", status),
            "export the voltages and currents, or the phasors, too");
      return false;
    }
    if (analogue < 1 || status < 0 ||
        number(f, 0, "number of channels") != static_cast<double>(analogue + status)) {
      fault("inconsistent numbers of channels", "total, analogue (with A) and status (with D) must agree",
            "export the configuration again");
      return false;
    }
    c_.status = static_cast<int>(status);
    for (long k = 0; k < analogue && !ended_; ++k) channel();
    for (long k = 0; k < status && !ended_; ++k) next();
    return !ended_;
  }

  void channel() {
    const Fields f = next();
    if (ended_) return;
    const bool old =
        c_.about.revision == 1991 && f.size() < kFields;  // no transformer ratio and side (P or S)
    if (f.size() < (old ? kFieldsOf1991 : kFields)) {
      fault(fmt::format("analogue channel with {} fields", f.size()),
            fmt::format("expected {} fields", old ? kFieldsOf1991 : kFields),
            "export the configuration again");
      return;
    }
    const double numbered = number(f, 0, "channel number");
    if (numbered <= last_channel_)
      fault(fmt::format("channel number '{}'", f[0]),
            fmt::format("it follows channel {:g}; numbers must increase", last_channel_),
            "export the configuration again");
    if (numbered > last_channel_ + 1)
      c_.about.notes.push_back(fmt::format(
          "Channel numbers skip from {:g} to {:g} ({}:{}): values are assigned in the order of the lines.",
          last_channel_, numbered, name_, number_));
    last_channel_ = numbered;
    ComtradeChannel c;
    c.id = f[1];
    c.phase = f[2];
    c.component = f[3];
    c.unit = f[4];
    c.a = number(f, 5, "multiplier a");
    c.b = number(f, 6, "offset b");
    c.skew = 1e-6 * (f[7].empty() ? 0.0 : number(f, 7, "skew"));
    if (old) {
      without_side_ = true;
      c_.about.channels.push_back(std::move(c));
      return;
    }
    const std::string side = capitals(f[12]);
    // Values on the primary side need no ratio.
    if (side != "P" || !f[10].empty()) c.primary = number(f, 10, "primary ratio");
    if (side != "P" || !f[11].empty()) c.secondary = number(f, 11, "secondary ratio");
    c.secondary_values = side == "S";
    if (side != "P" && side != "S")
      fault(fmt::format("side '{}'", f[12]), "it must be P (primary) or S (secondary)",
            "export the configuration again");
    if (c.secondary_values && !(c.primary > 0 && c.secondary > 0))
      fault(fmt::format("ratio {:g}/{:g}", c.primary, c.secondary),
            "values on the secondary side need a ratio", "enter it in the instrument, or mark the channel P");
    c_.about.channels.push_back(std::move(c));
  }

  void rates() {
    c_.about.nominal = number(next(), 0, "line frequency");
    const double n = number(next(), 0, "number of sampling rates");
    if (!(n >= 0 && n < 1000)) {
      fault("an invalid number of sampling rates", "it must be 0 to 999", "export the configuration again");
      return;
    }
    for (int k = 0; k < std::max(1.0, n) && !ended_; ++k) {
      const Fields f = next();
      if (ended_) return;
      const double rate = number(f, 0, "sampling rate"), last = number(f, 1, "last sample");
      const bool backwards = last <= static_cast<double>(c_.samples);
      if (rate < 0 || (n > 1 && rate == 0) || last < 1 || last > 1e9 || backwards)
        fault(
            fmt::format("rate {:g}, last sample {:g}", rate, last),
            backwards && c_.samples > 0
                ? fmt::format("the rate before it lasts to sample {}", c_.samples)
                : "a rate must be positive (0 only as the single rate), and the last sample must lie between 1 "
                  "and 1e9",
            "export the configuration again");
      if (n > 0 && rate > 0) c_.rates.emplace_back(rate, static_cast<long>(std::clamp(last, 0.0, 1e9)));
      c_.samples = static_cast<long>(std::clamp(last, 0.0, 1e9));
    }
  }

  void times() {
    const std::string_view first = take_line(rest_);
    ++number_;
    c_.about.start = c_.about.revision == 1991 ? start_of_1991(trim(first)) : std::string(trim(first));
    // Time stamps are in nanoseconds if the seconds of the date have more than six decimals (2013, clause
    // 7.4.7), otherwise in microseconds.
    const auto point = first.rfind('.');
    std::size_t digits = 0;
    while (point != std::string_view::npos && point + 1 + digits < first.size() &&
           std::isdigit(static_cast<unsigned char>(first[point + 1 + digits])) != 0)
      ++digits;
    next();  // trigger
    const Fields kind = next();
    c_.about.kind = kind.empty() ? "" : capitals(kind[0]);
    const auto& k = c_.about.kind;
    const bool wide = k == "BINARY32" || k == "FLOAT32";
    if (k != "ASCII" && k != "BINARY" && !wide)
      fault(fmt::format("data type '{}'", k), "the known types are ASCII, BINARY, BINARY32 and FLOAT32",
            "export the data again");
    if (wide && c_.about.revision < 2013)
      c_.about.notes.push_back(
          fmt::format("Data type {} exists since revision 2013, but the configuration states revision {}.", k,
                      c_.about.revision));
    const double multiplier = time_multiplier();
    // Stamps in ns exist since revision 2013.
    c_.stamp = (digits > 6 && c_.about.revision >= 2013 ? 1e-9 : 1e-6) * multiplier;
    if (!(multiplier > 0))
      fault("an invalid time multiplier", "it must be positive", "export the configuration again");
  }

  /// Returns the time multiplier of the last line, which exists since 1999; 1 if the line is missing.
  double time_multiplier() {
    const bool given = !trim(rest_.substr(0, rest_.find('\n'))).empty();
    if (given) return number(next(), 0, "time multiplier");
    if (c_.about.revision > 1991)
      c_.about.notes.push_back(fmt::format(
          "The configuration ends without the time multiplier ({}:{}): it was taken as 1.", name_, number_));
    return 1;
  }

  /// Converts "03/13/26,14:05:20.0" with the month first to the later form "13/03/2026,14:05:20.0".
  std::string start_of_1991(std::string_view text) {
    const Fields date_and_time = comtrade_fields(text);
    static const std::regex form(R"((\d{1,2})/(\d{1,2})/(\d{2}|\d{4}))");
    std::cmatch part;
    const std::string_view date = date_and_time[0];
    if (!std::regex_match(date.data(), date.data() + date.size(), part, form)) return std::string(text);
    int month = std::stoi(part[1]), day = std::stoi(part[2]), year = std::stoi(part[3]);
    const bool day_first = month > 12 && day <= 12;
    if (day_first) std::swap(month, day);
    if (year < 100) year += year < 70 ? 2000 : 1900;
    c_.about.notes.push_back(fmt::format(
        "The date {} was read as {:04}-{:02}-{:02}: {}.", date, year, month, day,
        day_first ? "there is no such month" : "revision 1991 of COMTRADE writes the month first"));
    return fmt::format("{:02}/{:02}/{:04}{}", day, month, year, text.substr(date.size()));
  }

  static constexpr std::size_t kFields = 13, kFieldsOf1991 = 10;
  std::string_view rest_;
  std::string name_;
  Problems& problems_;
  ComtradeConfig c_;
  int number_ = 0;
  double last_channel_ = 0;
  bool ended_ = false, without_side_ = false;
};

}  // namespace

std::vector<std::string_view> comtrade_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t at = 0;;) {
    const auto comma = line.find(',', at);
    fields.push_back(trim(line.substr(at, comma - at)));
    if (comma == std::string_view::npos) return fields;
    at = comma + 1;
  }
}

std::optional<double> comtrade_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || !std::isfinite(v))
    return std::nullopt;
  return v;
}

ComtradeConfig parse_comtrade_config(std::string_view bytes, const std::string& name, Problems& problems) {
  std::vector<std::string> notes;
  const std::string text = as_utf8(bytes, notes);
  std::string_view cfg = text;
  if (cfg.starts_with("\xEF\xBB\xBF")) cfg.remove_prefix(3);
  ComtradeConfig config = Config(cfg, name, problems).read();
  config.about.notes.insert(config.about.notes.begin(), notes.begin(), notes.end());
  return config;
}

}  // namespace swingbank::validate::record
