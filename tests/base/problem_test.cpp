#include "base/problem.hpp"

#include <gmock/gmock.h>

namespace swingbank {
namespace {

TEST(Shown, KeepsTextOfAnyLanguage) {
  for (const std::string text :
       {"Umspannwerk M\u00fcnchen", "\u0437\u0430\u043f\u0438\u0441\u044c", "\U0001f50c", ""})
    EXPECT_EQ(shown(text), text);
}

TEST(Shown, EscapesControlCharacters) {
  using namespace std::string_view_literals;
  EXPECT_EQ(shown("a\x1b[2Jb\x7f\r"sv), "a\\x1b[2Jb\\x7f\\x0d");
  EXPECT_EQ(shown("\xc2\x9b"
                  "2J"sv),
            "\\xc2\\x9b2J");
  EXPECT_EQ(shown("V\0P"sv), "V\\x00P");                     // not truncated at the null character
  EXPECT_EQ(shown("m\xfcller \xe4"sv), "m\\xfcller \\xe4");  // no UTF-8
}

TEST(Shown, TruncatesLongText) {
  const std::string text = shown(std::string(10'000'000, 'x'));
  EXPECT_LT(text.size(), 1100u);
  EXPECT_THAT(text, ::testing::EndsWith("(9999000 bytes more)"));
}

TEST(Shown, SentencesContainNoControlCharacters) {
  const InputError e({"no column", "\x1b]0;title", "it has\x07", "mend it"});
  EXPECT_STREQ(e.what(), "no column at \\x1b]0;title (it has\\x07): mend it");
}

}  // namespace
}  // namespace swingbank
