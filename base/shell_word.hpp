#pragma once
// Quoting of a word for a POSIX shell.
#include <string>
#include <string_view>

namespace swingbank {

/// Returns the text that a POSIX shell reads as this word: the word in single quotes, unless every character
/// is a letter, a digit or one of _./:=+,@%-.
inline std::string shell_word(std::string_view word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=+,@%-";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos) return std::string(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace swingbank
