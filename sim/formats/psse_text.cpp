#include "sim/formats/psse_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "base/encoding.hpp"
#include "base/input_file.hpp"

namespace swingbank::sim::formats::psse {
namespace {

bool blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Reads a quoted field from its opening quote at `i` and advances `i` past the closing one. Returns false if
/// there is no closing quote.
bool quoted_field(const std::string& line, std::size_t& i, Field& field) {
  const char mark = line[i++];
  field.quoted = true;
  for (; i < line.size(); ++i) {
    const char after = i + 1 < line.size() ? line[i + 1] : ' ';
    if (line[i] != mark) {
      field.text += line[i];
    } else if (after == mark) {
      field.text += line[i++];  // a doubled quote represents one quote
    } else if (!blank(after) && after != ',' && after != '/' && line.find(mark, i + 1) != std::string::npos) {
      field.text += line[i];  // an apostrophe inside a name, as written by PSS/E
    } else {
      ++i;
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::string> read_lines(const std::filesystem::path& file) {
  // Only names of buses and equipment may contain other characters than ASCII, so no note is needed.
  std::vector<std::string> notes;
  return lines_of(as_utf8(read_input(file, "cannot read the file", "check the path"), notes));
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

bool erase_byte_order_mark(std::vector<std::string>& lines) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (lines.empty() || !lines[0].starts_with(mark)) return false;
  lines[0].erase(0, mark.size());
  return true;
}

std::string trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

bool ends_section(const Record& record) {
  return !record.fields.empty() && !record.fields[0].quoted && record.fields[0].text == "0";
}
bool ends_file(const Record& record) {
  return !record.fields.empty() && !record.fields[0].quoted &&
         (record.fields[0].text == "Q" || record.fields[0].text == "q");
}

Record split(const std::string& line, int number, const std::string& file, Problems& problems,
             std::string_view comment_marks) {
  Record record{number, false, {}};
  constexpr std::size_t names = 4;  // number of leading fields that may be a name or an id
  bool separated = true;            // true after a comma or at the start: the next comma means an empty field
  for (std::size_t i = 0; i < line.size();) {
    const char c = line[i];
    if (blank(c)) {
      ++i;
    } else if (comment_marks.find(c) != std::string_view::npos &&
               (record.fields.empty() || !separated || record.fields.size() >= names ||
                i + 1 == line.size() || blank(line[i + 1]))) {
      break;
    } else if (c == '/') {
      record.ended = true;
      break;
    } else if (c == ',') {
      if (separated) record.fields.push_back({});
      separated = true;
      ++i;
    } else {
      Field field;
      if (c == '\'' || c == '"') {
        if (!quoted_field(line, i, field))
          problems.add("a quote is not closed", file + ":" + std::to_string(number),
                       "the name runs to the end of the line", "close it with " + std::string(1, c));
      } else {
        while (i < line.size() && !blank(line[i]) && line[i] != ',' && line[i] != '/')
          field.text += line[i++];
      }
      field.text = trimmed(field.text);
      record.fields.push_back(field);
      separated = false;
    }
  }
  return record;
}

const Field* Fields::given(std::size_t i) const {
  if (i >= record_.fields.size()) return nullptr;
  const Field& f = record_.fields[i];
  return f.text.empty() && !f.quoted ? nullptr : &f;
}

void Fields::missing(const char* name) {
  problems_.add(std::string(name) + " is missing", where(), "it has no default", "give " + std::string(name));
}

int Fields::integer(std::size_t i, const char* name, std::optional<int> fallback) {
  const Field* f = given(i);
  if (!f) {
    if (!fallback) missing(name);
    return fallback.value_or(0);
  }
  const char *begin = f->text.data(), *end = begin + f->text.size();
  if (begin != end && *begin == '+') ++begin;
  int value = 0;
  auto [stop, error] = std::from_chars(begin, end, value);
  const int most = 999999999;
  if (error == std::errc{} && stop != end)  // some programs write 1.0 for 1
    if (const auto number = parse_number(f->text);
        number && *number == std::trunc(*number) && std::abs(*number) <= most) {
      value = static_cast<int>(*number);
      stop = end;
    }
  if (error != std::errc{} || stop != end || value > most || value < -most) {
    problems_.add(std::string(name) + " = '" + f->text + "'", where(),
                  "it is not a whole number of at most nine digits",
                  "give such a number for " + std::string(name));
    return fallback.value_or(0);
  }
  return value;
}

long double Fields::number(std::size_t i, const char* name, std::optional<long double> fallback) {
  const Field* f = given(i);
  if (!f) {
    if (!fallback) missing(name);
    return fallback.value_or(0.0L);
  }
  if (const auto value = parse_number(f->text)) return *value;
  problems_.add(std::string(name) + " = '" + f->text + "'", where(), "it is not a finite number",
                "give a number for " + std::string(name));
  return fallback.value_or(0.0L);
}

std::string Fields::text(std::size_t i, const std::string& fallback) const {
  const Field* f = given(i);
  return f ? f->text : fallback;
}

std::optional<long double> parse_number(std::string text) {
  if (text.empty() || text.find_first_not_of("0123456789+-.eEdD") != std::string::npos) return {};
  for (char& c : text)
    if (c == 'd' || c == 'D') c = 'e';
  char* end = nullptr;
  long double value = std::strtold(text.c_str(), &end);
  // Rounding twice, to extended precision and then to double, misses the nearest double for one decimal in
  // 2,000.
  if (const double nearest = std::strtod(text.c_str(), nullptr); static_cast<double>(value) != nearest)
    value = std::nextafter(value, static_cast<long double>(nearest));
  // A value beyond the range of double would become infinite later.
  if (*end != '\0' || !std::isfinite(static_cast<double>(value))) return {};
  return value;
}

std::string shortest(double value, long double scale) {
  if (!std::isfinite(value)) return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";  // in messages
  const long double scaled = scale * static_cast<long double>(value);
  char text[64];
  // All digits before the decimal point, so that 100 is not written as 1e+02.
  const int whole = value == 0.0 ? 1 : static_cast<int>(std::floor(std::log10(std::abs(scaled)))) + 1;
  for (int digits = std::clamp(whole, 1, 12); digits <= 21; ++digits) {
    std::snprintf(text, sizeof text, "%.*Lg", digits, scaled);
    if (const auto read = parse_number(text); read && static_cast<double>(*read / scale) == value) break;
  }
  return text;
}

std::string quote(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace swingbank::sim::formats::psse
