#pragma once
// The text of PSLF's files: words, names in double quotes, ':' between what a record is of and what it says,
// '/' at the end of a line that goes on, comments behind '#' or '@'. Used by the readers of .dyd and .epc
// only.
#include <string>
#include <string_view>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::sim::formats::pslf {

struct Token {
  std::string text;
  bool quoted = false;
};
/// A record with the lines that continue it; nothing is behind the colon where it has none.
struct Line {
  int number = 0;  ///< where it begins, from 1
  bool colon = false;
  std::vector<Token> head, tail;         ///< before and behind the colon
  std::vector<std::size_t> starts = {};  ///< for each line that continues it, how much of `tail` is before it
};

std::string lower(std::string_view text);
/// Without blanks and line ends at both ends.
std::string trimmed(std::string_view text);
/// Whether a line says nothing: it is blank or a comment.
bool says_nothing(const std::string& line);
/// Words, texts in quotes, ':' by itself. A quote without an end is told.
std::vector<Token> tokens_of(const std::string& text, const std::string& where, Problems& problems);
/// The record that begins at lines[at], before `end`; leaves `at` behind its last line. `file`: for messages.
Line record_at(const std::vector<std::string>& lines, std::size_t& at, std::size_t end,
               const std::string& file, Problems& problems);

}  // namespace swingbank::sim::formats::pslf
