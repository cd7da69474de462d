#pragma once
// Cells of text in columns: separators, numbers, and ways to say that there is no value.
#include <string_view>
#include <vector>

#include "validate/record/record.hpp"

namespace swingbank::validate::record {

using Cells = std::vector<std::string_view>;

/// Without blanks and quotes around it.
std::string_view unquoted(std::string_view text);
/// Cells of a line; a separator between quotes is text, and blanks separate in any number.
Cells split(std::string_view line, char separator);

struct Number {
  double value;  ///< NaN where it is none
  int decimals = 0;
  bool ok = false, comma = false, point = false;  ///< what divides the decimals
  bool ambiguous = false;  ///< no number, since a comma may divide thousands or decimals
};
/// A number; decimal commas where commas do not separate, thousands divided by the other mark, by blanks or
/// by apostrophes: "339,515.0", "339.515,0", "1 234,5".
Number parse_number(std::string_view cell, char separator);

/// Ways to say that there is no value, in seven languages and by historians, and cells without a letter or
/// digit.
bool says_missing(std::string_view cell);
/// Whether a cell is a word, not a number that is written wrongly.
bool is_word(std::string_view cell);
/// Codes that instruments write instead of a value.
bool is_code(double value);

/// Where the table of a text begins: its separator, and the line of its heading, counted from 0 over all
/// lines.
struct TableTop {
  char separator = ',';
  int line = 0;
};
/// The first lines decide by the line that names the most quantities, with any separator; lines before it may
/// be written otherwise. Without such a line the first one that is no title decides.
TableTop find_top(std::string_view text, const ColumnMap& columns);

}  // namespace swingbank::validate::record
