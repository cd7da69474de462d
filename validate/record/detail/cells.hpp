#pragma once
// Cells of text columns: separators, numbers, and spellings of a missing value.
#include <string_view>
#include <vector>

#include "validate/record/record.hpp"

namespace swingbank::validate::record {

using Cells = std::vector<std::string_view>;

/// Returns the text without surrounding blanks and quotes.
std::string_view unquoted(std::string_view text);
/// Splits a line into cells. Separators between quotes are text. Several blanks count as one separator.
Cells split(std::string_view line, char separator);

struct Number {
  double value;  ///< NaN if the cell is not a number
  int decimals = 0;
  bool ok = false, comma = false, point = false;  ///< valid number; decimal comma; decimal point
  bool ambiguous = false;  ///< not a number, because its comma may separate thousands or decimals
};
/// Parses a number. A decimal comma is allowed if `separator` is not a comma. Thousands may be separated by
/// commas or points (the mark that does not separate decimals), blanks or apostrophes: "339,515.0",
/// "339.515,0", "1 234,5".
Number parse_number(std::string_view cell, char separator);

/// Returns whether a cell denotes a missing value. Such cells contain a word for it in one of seven
/// languages, such a word of a data historian, or neither letters nor digits.
bool says_missing(std::string_view cell);
/// Returns whether a cell is a word rather than an invalid number.
bool is_word(std::string_view cell);
/// Returns whether a value is a code that instruments write for a missing value.
bool is_code(double value);

/// Start of the table in a text: its separator, and the line of its heading, counted from 0 over all lines.
struct TableTop {
  char separator = ',';
  int line = 0;
};
/// Finds the heading among the first 60 lines: the line that names the most quantities (at least two),
/// whatever its separator. Earlier lines may have another format. If there is no heading, returns the first
/// line with several cells.
TableTop find_top(std::string_view text, const ColumnMap& columns);

}  // namespace swingbank::validate::record
