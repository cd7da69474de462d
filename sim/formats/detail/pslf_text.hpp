#pragma once
// Tokens and records of PSLF's text files: words, names in double quotes, ':' between equipment and values,
// '/' at the end of a continued line, comment lines that begin with '#' or '@'. Used only by the readers of
// .dyd and .epc.
#include <string>
#include <string_view>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::sim::formats::pslf {

/// A word, a quoted string or ':'.
struct Token {
  std::string text;
  bool quoted = false;
};
/// A record with its continuation lines; `tail` is empty without a colon.
struct Line {
  int number = 0;  ///< first line, from 1
  bool colon = false;
  std::vector<Token> head, tail;         ///< tokens before and after the colon
  std::vector<std::size_t> starts = {};  ///< per continuation line: number of `tail` tokens before it
};

std::string lower(std::string_view text);
/// Returns true if a line is blank or a comment.
bool says_nothing(const std::string& line);
/// Splits a text into words, quoted strings and ':'. An unterminated quote becomes a problem.
std::vector<Token> tokens_of(const std::string& text, const std::string& where, Problems& problems);
/// Returns the record that begins at lines[at] and ends before line `end`. Advances `at` past its last line.
/// `file`: name in messages.
Line record_at(const std::vector<std::string>& lines, std::size_t& at, std::size_t end,
               const std::string& file, Problems& problems);

}  // namespace swingbank::sim::formats::pslf
