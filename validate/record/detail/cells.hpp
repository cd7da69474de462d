#pragma once
// Cells of text columns: separators, numbers, and spellings of a missing value.
#include <string_view>
#include <vector>

#include "validate/record/record.hpp"

namespace swingbank::validate::record {

using Cells = std::vector<std::string_view>;

/// Returns the text without surrounding blanks and quotes.
std::string_view unquoted(std::string_view text);
/// Splits a line into cells. Separators between quotes are text; any number of blanks counts as one
/// separator.
Cells split(std::string_view line, char separator);

struct Number {
  double value;  ///< NaN if the cell is no number
  int decimals = 0;
  bool ok = false, comma = false, point = false;  ///< decimal mark
  bool ambiguous = false;  ///< no number, because its comma may separate thousands or decimals
};
/// Parses a number. Decimal commas are allowed if commas are not separators. Thousands may be separated by
/// the other mark, blanks or apostrophes: "339,515.0", "339.515,0", "1 234,5".
Number parse_number(std::string_view cell, char separator);

/// Returns whether a cell denotes a missing value: words in seven languages and of historians, or no letter
/// or digit.
bool says_missing(std::string_view cell);
/// Returns whether a cell is a word rather than an invalid number.
bool is_word(std::string_view cell);
/// Returns whether a value is a code that instruments write for a missing one.
bool is_code(double value);

/// Start of the table in a text: its separator, and the line of its heading, counted from 0 over all lines.
struct TableTop {
  char separator = ',';
  int line = 0;
};
/// Finds the heading: the line among the first ones that names the most quantities, with any separator;
/// earlier lines may have another format. Without such a line, the first one that is no title.
TableTop find_top(std::string_view text, const ColumnMap& columns);

}  // namespace swingbank::validate::record
