#include "validate/record/detail/stamp.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "validate/record/detail/units.hpp"

namespace swingbank::validate::record {
namespace {

/// Names of the months, normalised; an abbreviation has at least the first three letters.
constexpr std::array<std::string_view, 12> kMonths = {
    "january januar janner janvier enero janeiro gennaio январь января",
    "february februar feber fevrier febrero fevereiro febbraio февраль февраля",
    "march marz mrz mars marzo marco март марта",
    "april avril abril aprile апрель апреля",
    "may mai mayo maio maggio май мая",
    "june juni juin junio junho giugno июнь июня",
    "july juli juillet julio julho luglio июль июля",
    "august aout agosto август августа",
    "september septembre septiembre setiembre setembro settembre сентябрь сентября",
    "october oktober octobre octubre outubro ottobre октябрь октября",
    "november novembre noviembre novembro ноябрь ноября",
    "december dezember decembre diciembre dezembro dicembre декабрь декабря"};
/// Words of a date that carry no information.
constexpr std::string_view kIdleInDates =
    "de del di of the den le mon tue tues wed thu thur thurs fri sat sun monday tuesday wednesday thursday friday "
    "saturday sunday g г";

/// Returns the month, 1 to 12; 0 if no month or several months match.
long month_of(std::string_view word) {
  const std::size_t letters = static_cast<std::size_t>(
      std::ranges::count_if(word, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
  if (letters < 3) return 0;
  long month = 0;
  for (std::size_t m = 0; m < kMonths.size(); ++m) {
    const std::string_view names = kMonths[m];
    for (std::size_t at = names.find(word); at != std::string_view::npos; at = names.find(word, at + 1)) {
      if (at > 0 && names[at - 1] != ' ') continue;
      if (month != 0 && month != static_cast<long>(m) + 1) return 0;
      month = static_cast<long>(m) + 1;
    }
  }
  return month;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
}

struct Part {
  std::string_view text;
  bool number = false;
  char before = '\0';  ///< separator before this part
};

long number_of(std::string_view digits) {
  long v = -1;
  std::from_chars(digits.data(), digits.data() + digits.size(), v);
  return v;
}

bool day_of(long year, long month, long day, long& days) {
  using namespace std::chrono;
  if (year >= 0 && year < 80) year += 2000;
  if (month < 1 || month > 12 || day < 1 || day > 31) return false;
  const year_month_day date{std::chrono::year(static_cast<int>(year)),
                            std::chrono::month(static_cast<unsigned>(month)),
                            std::chrono::day(static_cast<unsigned>(day))};
  if (year < 1900 || year > 2200 || !date.ok()) return false;
  days = sys_days(date).time_since_epoch().count();
  return true;
}

class Reader {
 public:
  Reader(std::string_view text, bool day_first) : rest_(text), day_first_(day_first) {}

  std::optional<Stamp> read() {
    const bool timed = time_alone();
    if (!timed && (!date() || !time())) return std::nullopt;
    return end() ? std::optional(stamp_) : std::nullopt;
  }

 private:
  /// Parses a time of day without a date, which begins with one or two digits and a colon.
  [[nodiscard]] bool time_alone() {
    const auto colon = rest_.find(':');
    if (colon == 0 || colon > 2 ||
        !std::all_of(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(colon), is_digit))
      return false;
    return time();
  }

  /// Reads digits or letters, and the separator before them.
  std::optional<Part> part() {
    Part p;
    while (!rest_.empty() && !is_digit(rest_.front()) && !is_letter(rest_.front())) {
      if (std::string_view(" -/.,_'").find(rest_.front()) == std::string_view::npos) return std::nullopt;
      if (p.before == '\0' || p.before == ' ') p.before = rest_.front();
      rest_.remove_prefix(1);
    }
    if (rest_.empty()) return std::nullopt;
    p.number = is_digit(rest_.front());
    std::size_t n = 0;
    while (n < rest_.size() && (p.number ? is_digit(rest_[n]) : is_letter(rest_[n]))) ++n;
    p.text = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return p;
  }

  /// Reads a date: three numbers, two numbers and a month's name in any order, or eight digits. Then skips
  /// the separator of date and time.
  bool date() {
    std::vector<Part> numbers;
    long month = 0;
    std::size_t month_at = 0;
    for (int parts = 0; parts < 8; ++parts) {
      const std::string_view before = rest_;
      const auto p = part();
      if (!p) return false;
      if (p->number && (p->text.size() == 8 || p->text.size() == 14) && numbers.empty() && month == 0) {
        if (!day_of(number_of(p->text.substr(0, 4)), number_of(p->text.substr(4, 2)),
                    number_of(p->text.substr(6, 2)), stamp_.day))
          return false;
        if (p->text.size() == 14) {
          rest_ = before;
          while (!is_digit(rest_.front())) rest_.remove_prefix(1);
          rest_.remove_prefix(8);
          return true;
        }
        return divide();
      }
      if (p->number) {
        if (p->text.size() > 4) return false;
        numbers.push_back(*p);
      } else {
        const std::string word = normalised(p->text);
        if (const long m = month_of(word); m != 0 && month == 0)
          month = m, month_at = numbers.size();
        else if (!is_word_of(word, kIdleInDates))
          return false;
      }
      if (numbers.size() + (month != 0 ? 1 : 0) == 3) break;
    }
    const auto value = [&](std::size_t i) { return number_of(numbers[i].text); };
    bool ok = false;
    if (month != 0 && numbers.size() == 2)
      ok = numbers[0].text.size() == 4 ? month_at > 0 && day_of(value(0), month, value(1), stamp_.day)
                                       : day_of(value(1), month, value(0), stamp_.day);
    else if (numbers.size() == 3 && numbers[0].text.size() == 4)
      ok = day_of(value(0), value(1), value(2), stamp_.day);
    else if (numbers.size() == 3 && numbers[1].before == '.')
      ok = day_of(value(2), value(1), value(0), stamp_.day);
    else if (numbers.size() == 3 && numbers[0].text.size() <= 2) {
      const auto read = [&](bool day_first) {
        stamp_.day_first = day_first;
        return day_of(value(2), value(day_first ? 1 : 0), value(day_first ? 0 : 1), stamp_.day);
      };
      ok = read(day_first_) || read(!day_first_);
    }
    return ok && divide();
  }

  /// Skips the separator of date and time: blanks, a comma, "T", a colon, a hyphen, "at".
  bool divide() {
    const std::size_t size = rest_.size();
    while (!rest_.empty() && std::string_view(" ,_T").find(rest_.front()) != std::string_view::npos)
      rest_.remove_prefix(1);
    for (const std::string_view word : {"г.", "at ", "um ", "-", ":"})
      if (rest_.starts_with(word)) {
        rest_.remove_prefix(word.size());
        break;
      }
    while (!rest_.empty() && rest_.front() == ' ') rest_.remove_prefix(1);
    return rest_.size() < size;
  }

  /// Reads "12:56:20.033", "12:56:20:033", "125620.033", "12.56.20,033" after a date, "56:20.0", "12:56".
  bool time() {
    std::array<long, 3> hms{};
    std::size_t n = 0;
    if (rest_.size() >= 6 && std::all_of(rest_.begin(), rest_.begin() + 6, is_digit)) {
      for (; n < 3; ++n) hms[n] = number_of(rest_.substr(2 * n, 2));
      rest_.remove_prefix(6);
    } else {
      char divides = ':';
      while (n < 3) {
        std::size_t digits = 0;
        while (digits < rest_.size() && is_digit(rest_[digits])) ++digits;
        if (digits < 1 || digits > 2) return false;
        hms[n++] = number_of(rest_.substr(0, digits));
        rest_.remove_prefix(digits);
        if (n == 3) break;
        if (n == 1 && stamp_.day != 0 && rest_.starts_with('.')) divides = '.';
        if (rest_.empty() || rest_.front() != divides) break;
        rest_.remove_prefix(1);
      }
    }
    if (n < 2) return false;
    const bool fraction =
        !rest_.empty() && std::string_view(".,:").find(rest_.front()) != std::string_view::npos;
    if (n == 2 && fraction) {
      stamp_.in_hour = true;
      hms = {0, hms[0], hms[1]};
    } else if (n == 2) {
      stamp_.resolution = 60;
    }
    double part = 0;
    if (fraction) {
      rest_.remove_prefix(1);
      for (; !rest_.empty() && is_digit(rest_.front()); rest_.remove_prefix(1)) {
        stamp_.resolution /= 10;
        part = 10 * part + (rest_.front() - '0');
      }
      part *= stamp_.resolution;
    }
    stamp_.second = static_cast<double>(hms[0] * 3600 + hms[1] * 60 + hms[2]) + part;
    return hms[0] < 24 && hms[1] < 60 && hms[2] < 61;
  }

  /// Reads the end of a stamp: "PM", "p. m.", "Z", "+02:00", "CET", "UTC+1".
  bool end() {
    const auto skip = [&] {
      while (!rest_.empty() && rest_.front() == ' ') rest_.remove_prefix(1);
    };
    skip();
    const auto letter = rest_.find_first_of("mM", 1);
    const std::string half = letter < 5 ? normalised(rest_.substr(0, letter + 1)) : std::string();
    if (half == "am" || half == "pm") {
      const double hour = 3600;
      // No hours are added to "13:05 PM", which some programs write.
      if (half == "pm" && stamp_.second < 12 * hour) stamp_.second += 12 * hour;
      if (half == "am" && stamp_.second >= 13 * hour) return false;
      if (half == "am" && stamp_.second >= 12 * hour) stamp_.second -= 12 * hour;
      rest_.remove_prefix(letter + 1);
      if (rest_.starts_with('.')) rest_.remove_prefix(1);
      skip();
    }
    if (rest_.empty()) return true;
    std::size_t letters = 0;
    while (letters < rest_.size() && is_letter(rest_[letters])) ++letters;
    const std::string zone = normalised(rest_.substr(0, letters));
    const bool utc = is_word_of(zone, "z utc gmt");
    if (letters > 5 || (letters > 0 && !utc && letters < 3)) return false;
    rest_.remove_prefix(letters);
    stamp_.zoned = utc || letters == 0;  // the meaning of other zone names depends on the country
    if (rest_.empty()) return true;
    const bool east = rest_.front() == '+';
    if ((!east && rest_.front() != '-') || (letters > 0 && !utc)) return false;
    rest_.remove_prefix(1);
    std::string digits;
    for (const char c : rest_)
      if (is_digit(c))
        digits += c;
      else if (c != ':')
        return false;
    if (digits.empty() || digits.size() > 4 || digits.size() == 3) return false;
    const long hours = number_of(std::string_view(digits).substr(0, 2));
    const long minutes = digits.size() == 4 ? number_of(std::string_view(digits).substr(2)) : 0;
    stamp_.second -= (east ? 1 : -1) * static_cast<double>(hours * 3600 + minutes * 60);
    return true;
  }

  std::string_view rest_;
  bool day_first_;
  Stamp stamp_;
};

}  // namespace

std::optional<Stamp> parse_stamp(std::string_view text, bool day_first) {
  // Plain numbers are not stamps, except fourteen digits: year to second.
  const auto other = text.find_first_not_of("0123456789.+-eE");
  if (other == std::string_view::npos) {
    const auto digits = std::min(text.find_first_not_of("0123456789"), text.size());
    if (digits != 14) return std::nullopt;
  }
  return Reader(text, day_first).read();
}

}  // namespace swingbank::validate::record
