#include "validate/record/detail/cells.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "validate/record/detail/columns.hpp"
#include "validate/record/detail/text.hpp"

namespace swingbank::validate::record {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Returns the digits without the thousands separator `mark`; no value if `mark` does not separate groups of
/// three digits.
std::optional<std::string> ungrouped(std::string_view digits, std::string_view mark) {
  std::string all;
  std::size_t group = 0, groups = 0;
  while (true) {
    const std::size_t end = std::min(digits.find(mark), digits.size());
    const std::string_view part = digits.substr(0, end);
    if (part.empty() || !std::ranges::all_of(part, is_digit)) return std::nullopt;
    if (groups++ > 0 ? part.size() != 3 : part.size() > 3) return std::nullopt;
    group = part.size();
    all += part;
    if (end == digits.size()) break;
    digits.remove_prefix(end + mark.size());
  }
  return group == 3 && groups > 1 ? std::optional(all) : std::nullopt;
}

/// Returns the number with a decimal point, without thousands separators.
std::string plain(std::string_view cell, char separator, Number& n) {
  std::string sign;
  if (!cell.empty() && (cell.front() == '-' || cell.front() == '+')) {
    if (cell.front() == '-') sign = "-";
    if (cell.size() > 1 && is_digit(cell[1]))
      cell.remove_prefix(1);
    else if (cell.front() == '-' || (cell.size() > 1 && cell[1] == '-'))
      sign.clear();
    else
      cell.remove_prefix(1);
  }
  const auto comma = cell.find(','), point = cell.find('.');
  const auto npos = std::string_view::npos;
  // The last mark separates the decimals; marks of the other kind before it separate thousands.
  const auto last_comma = cell.rfind(','), last_point = cell.rfind('.');
  const bool commas_first = comma != npos && point != npos && last_comma < point;
  const bool points_first = comma != npos && point != npos && last_point < comma;
  std::string_view whole = cell, rest;
  if (commas_first || (comma == npos && point != npos))
    whole = cell.substr(0, point), rest = cell.substr(point);
  else if (points_first || (comma != npos && point == npos && separator != ',' && comma == last_comma))
    whole = cell.substr(0, comma), rest = cell.substr(comma);
  for (const std::string_view mark : {",", ".", "'", "\xE2\x80\x99", " ", "\xC2\xA0", "\xE2\x80\xAF"}) {
    if (whole.find(mark) == npos) continue;
    const auto digits = ungrouped(whole, mark);
    if (!digits) return sign + std::string(cell);
    if (rest.empty() && mark == "," && comma == last_comma) {
      n.ambiguous = true;
      return {};
    }
    if (rest.empty() && mark == ".") break;
    n.comma = rest.starts_with(',');
    return sign + *digits + (rest.empty() ? "" : "." + std::string(rest.substr(1)));
  }
  if (rest.starts_with(',')) {
    n.comma = true;
    return sign + std::string(whole) + "." + std::string(rest.substr(1));
  }
  return sign + std::string(cell);
}

/// Returns whether blanks separate the values: at least three of the first 50 lines consist of three or more
/// numbers separated by blanks.
bool by_blanks(std::string_view text) {
  int found = 0;
  for (int n = 0; n < 50 && !text.empty(); ++n) {
    const std::string_view line = unquoted(take_line(text));
    if (line.empty() || line.find_first_of(",;\t") != std::string_view::npos) continue;
    const Cells cells = split(line, ' ');
    if (cells.size() >= 3 && std::ranges::all_of(cells, [](auto c) { return parse_number(c, ' ').ok; }) &&
        ++found == 3)
      return true;
  }
  return false;
}

/// Returns the most frequent separator of the line.
char separator_of(std::string_view line) {
  char best = ',';
  std::size_t most = split(line, best).size();
  for (const char c : {';', '\t'})
    if (const auto n = split(line, c).size(); n > most) best = c, most = n;
  return best;
}

}  // namespace

std::string_view unquoted(std::string_view s) { return trimmed(s, " \t\r\""); }

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

Number parse_number(std::string_view cell, char separator) {
  Number n{.value = std::numeric_limits<double>::quiet_NaN()};
  std::string text;
  if (cell.find_first_not_of("0123456789.eE-") != std::string_view::npos) {
    text = plain(cell, separator, n);
    cell = text;
  }
  if (n.ambiguous) return n;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), n.value);
  n.ok = !cell.empty() && error == std::errc{} && end == cell.data() + cell.size();
  if (const auto point = cell.find('.'); point != std::string_view::npos) {
    n.point = !n.comma;
    n.decimals = static_cast<int>(std::min(cell.find_first_of("eE"), cell.size()) - point - 1);
    if (cell.find_first_of("eE") != std::string_view::npos) n.decimals = 0;
  }
  if (!n.ok) n.value = std::numeric_limits<double>::quiet_NaN();
  return n;
}

bool says_missing(std::string_view cell) {
  constexpr std::string_view kWords =
      "nan na null none nil bad missing nodata novalue notavailable notanumber baddata badinput badquality invalid "
      "error failed fail timeout iotimeout commfail calcfailed ptcreated shutdown intfshut scanoff notconnect "
      "offline overrange underrange configure unavailable undefined undef empty div0 num value ref name "
      "ndef keinwert keinedaten keinezahl fehlt ungultig fehler schlecht nichtverfugbar "
      "nonnumerique nonnumero nonunnombre pasdedonnees pasdevaleur aucunedonnee sansvaleur manquant invalide "
      "indisponible neun noesunnumero sindatos sinvalor nohaydatos invalido malo nodisponible "
      "naoeumnumero semdados semvalor semvalores naodisponivel ruim nonunnumero nonunnumeroreale nessundato "
      "nessunvalore datomancante nondisponibile mancante нечисло нетданных нетзначения нд ошибка плохое";
  const std::string word = normalised(cell);
  if (word.empty()) return true;
  if (cell.find("#IND") != std::string_view::npos || cell.find("#QNAN") != std::string_view::npos ||
      cell.find("#SNAN") != std::string_view::npos)
    return true;  // "-1.#IND", as older programs on Windows write it
  return is_word_of(word, kWords) || word.starts_with("nan");
}

bool is_word(std::string_view cell) {
  const bool letters = std::ranges::any_of(cell, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
  });
  return letters && std::ranges::none_of(cell, is_digit) && normalised(cell).size() >= 2 &&
         !parse_number(cell, ' ').ok;
}

bool is_code(double v) {
  const double size = std::abs(v);  // +999 may be a power in MW
  return v == -999.0 || size == 9999.0 || size == 99999.0 || size == 999999.0 || size >= 1e30;
}

TableTop find_top(std::string_view text, const ColumnMap& columns) {
  constexpr int kLinesOfTop = 60;
  const bool blanks = by_blanks(text);
  TableTop top{.separator = ','};
  std::size_t most = 1;
  bool found = false;
  const auto counts = [&](std::string_view cell) {
    if (cell.empty() || parse_number(cell, ',').ok) return false;
    if (column_meaning(cell)) return true;
    return cell.size() > 1 && std::ranges::any_of(columns, [&](const auto& named) {
             return named.second.find(cell) != std::string::npos;
           });
  };
  int first = -1;
  for (int n = 0; n < kLinesOfTop && !text.empty(); ++n) {
    const std::string_view line = take_line(text);
    const std::string_view content = unquoted(line);
    if (content.empty() || content.front() == '#') continue;
    for (const char separator : {',', ';', '\t', ' '}) {
      if (blanks != (separator == ' ')) continue;
      const Cells cells = split(line, separator);
      std::size_t quantities = 0;
      for (const auto cell : cells) quantities += counts(cell) ? 1 : 0;
      if (quantities > most) most = quantities, top = {separator, n}, found = true;
    }
    // Without a known heading, the table begins at the first line with several cells.
    const char separator = blanks ? ' ' : separator_of(line);
    if (!found && first < 0 && split(line, separator).size() > 1) top = {separator, n}, first = n;
  }
  return top;
}

}  // namespace swingbank::validate::record
