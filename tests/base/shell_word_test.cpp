// Quoting of words: a shell reads back the same word.
#include "base/shell_word.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>

namespace swingbank {
namespace {

std::string read_by_shell(const std::string& text) {
  const std::unique_ptr<FILE, int (*)(FILE*)> shell(::popen(("printf '%s' " + text).c_str(), "r"), ::pclose);
  std::array<char, 256> buffer{};
  return {buffer.data(), std::fread(buffer.data(), 1, buffer.size(), shell.get())};
}

TEST(ShellWord, IsReadBackByTheShell) {
  for (const std::string word : {"event1.csv", "two words", "$HOME/`id`", "it's", "\"quoted\"", "a\\b", "*",
                                 "#1", "~", "line\nbreak", "", "x;y&z|w"})
    EXPECT_EQ(read_by_shell(shell_word(word)), word);
}

TEST(ShellWord, PlainWordsStayWithoutQuotes) {
  EXPECT_EQ(shell_word("records/event-1.csv"), "records/event-1.csv");
}

}  // namespace
}  // namespace swingbank
