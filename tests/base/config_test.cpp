#include "base/config.hpp"

#include <gmock/gmock.h>

#include <functional>

namespace swingbank {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string sentence_of(Config& c) {
  try {
    c.raise();
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing thrown";
}

TEST(StrictConfig, ReadsGivenValues) {
  Config c("a = 1\nb = 2\ns = 'x'\n[t]\nlist = [1, 2.5]\nbox = [0.5, 1]\nwords = ['u', 'v']\n", "c.toml");
  EXPECT_EQ(c.require<std::int64_t>("a"), 1);
  EXPECT_EQ(c.require<double>("b"), 2.0);  // an integer is a number
  EXPECT_EQ(c.require<std::string>("s"), "x");
  EXPECT_EQ(c.require<std::vector<double>>("t.list"), (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(c.interval("t.box"), (std::pair{0.5, 1.0}));
  EXPECT_EQ(c.require<std::vector<std::string>>("t.words").size(), 2u);
  EXPECT_EQ(c.optional<double>("absent", 3.5), 3.5);
  EXPECT_NO_THROW(c.raise());
}

/// Returns a dotted key "a.a.a" with the given number of parts.
std::string dotted(int parts) {
  std::string key = "a";
  for (int k = 1; k < parts; ++k) key += ".a";
  return key;
}

TEST(StrictConfig, RefusesKeysOfVeryManyParts) {
  const int many = 60'000;
  for (const std::string& text :
       {"x = 1\n[" + dotted(many) + "]\n", "x = 1\n" + dotted(many) + " = 1\n",
        "x = 1\n[[" + dotted(many) + "]]\n", "x = 1\nt = {b = 1, " + dotted(many) + " = 1}\n",
        "x = 1\nt = [{" + dotted(many) + " = 1}]\n", "x = 1\n\"b\" . 'c' . " + dotted(many) + " = 1\n"})
    try {
      Config c(text, "deep.toml");
      ADD_FAILURE() << text.substr(0, 40);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("a key nested deeper than 32 levels at deep.toml:2:"))
          << text.substr(0, 40);
    }
}

TEST(StrictConfig, ReadsDotsOutsideOfKeys) {
  const std::string dots(100, '.');
  Config c("[" + dotted(32) + "]\nb = '" + dots + "' # " + dots + "\nc = \"\"\"\"" + dots + "\n\\\"" + dots +
               "\"\"\"\"\nd = [0.5, 1.5" + ", 2.5, 3.5\n]\n",
           "c.toml");
  EXPECT_EQ(c.require<std::string>(dotted(32) + ".b"), dots);
  EXPECT_EQ(c.require<std::string>(dotted(32) + ".c"), "\"" + dots + "\n\"" + dots + "\"");
  EXPECT_EQ(c.require<std::vector<double>>(dotted(32) + ".d").size(), 4U);
}

TEST(StrictConfig, RefusesAnEmptyInterval) {
  Config c("box = []\n", "c.toml");
  c.interval("box");
  EXPECT_THAT(sentence_of(c), HasSubstr("box has 0 numbers"));
}

TEST(StrictConfig, ReportsAllProblemsWithTheirLines) {
  Config c("a = 'one'\nb = 7\nzzz = 1\n[t]\nunheard = 2\nbox = [3, 1]\nmode = 'blue'\n", "c.toml");
  c.require<std::int64_t>("a");
  c.require<double>("b", {0.0, 5.0, "s"});
  c.require<bool>("gone");
  c.interval("t.box");
  c.choice("t.mode", {"red", "green"});
  const std::string s = sentence_of(c);
  EXPECT_THAT(s, HasSubstr("c.toml:1:5 (it must be an integer)"));
  EXPECT_THAT(s, HasSubstr("c.toml:2:5 (it must be 0 to 5 s)"));
  EXPECT_THAT(s, HasSubstr("missing key gone at c.toml"));
  EXPECT_THAT(s, HasSubstr("unknown key zzz at c.toml:3:1"));
  EXPECT_THAT(s, HasSubstr("unknown key t.unheard at c.toml:5:1"));
  EXPECT_THAT(s, HasSubstr("c.toml:6:7 (the low end lies above the high end)"));
  EXPECT_THAT(s, HasSubstr("use one of: red, green"));
}

TEST(StrictConfig, SuggestsOnlyKeysThatTheTableLacks) {
  Config c("Xd = 1.8\nXdd = 0.3\nXq = 1.7\n", "c.toml");
  for (const char* key : {"Xd", "Xdp", "Xq"}) c.optional<double>(key, 0.0);
  EXPECT_THAT(sentence_of(c), HasSubstr("remove it or use one of: Xd, Xdp, Xq; did you mean Xdp?"));
  Config full("Xd = 1.8\nXdd = 0.3\n", "c.toml");
  full.require<double>("Xd");
  EXPECT_EQ(sentence_of(full),
            "unknown key Xdd at c.toml:2:1 (Swingbank has no such key): remove it or use one of: Xd");
}

TEST(StrictConfig, UnknownTableIsNamedOnce) {
  Config c("a = 1\n[other]\nx = 1\ny = 2\n", "c.toml");
  c.require<std::int64_t>("a");
  const std::string s = sentence_of(c);
  EXPECT_THAT(s, HasSubstr("unknown key other at c.toml:2:2"));
  EXPECT_THAT(s, Not(HasSubstr("other.x")));
}

TEST(StrictConfig, EmptyTextIsRefusedWhereItIsNoChoice) {
  Config c("who = ''\nmode = ''\nright = ''\nwrong = 5\n", "c.toml");
  c.choice("who", {"one", "all"});
  c.choice("mode", {"one", "all"}, "one");
  c.choice("right", {"", "all"}, "");
  c.choice("wrong", {"one", "all"});
  const std::string s = sentence_of(c);
  EXPECT_THAT(s, HasSubstr("who = '' at c.toml:1:7 (this value is not allowed)"));
  EXPECT_THAT(s, HasSubstr("mode = '' at c.toml:2:8 (this value is not allowed)"));
  EXPECT_THAT(s, Not(HasSubstr("right")));
  EXPECT_THAT(s, HasSubstr("wrong = 5 at c.toml:4:9 (it must be a text in quotes)"));
  EXPECT_THAT(s, Not(HasSubstr("wrong = ''")));
}

TEST(StrictConfig, EmptyFileNameIsRefused) {
  Config c("raw = ''\n", "c.toml");
  c.file("raw");
  c.file("dyr");
  const std::string s = sentence_of(c);
  EXPECT_THAT(s, HasSubstr("raw = '' at c.toml:1:7 (it must name a file)"));
  EXPECT_THAT(s, HasSubstr("missing key dyr at c.toml"));
  EXPECT_THAT(s, Not(HasSubstr("dyr = ''")));
}

TEST(StrictConfig, NotANumberIsRefused) {
  Config c("a = nan\nb = inf\n", "c.toml");
  c.require<double>("a");
  c.require<double>("b");
  EXPECT_THAT(sentence_of(c), HasSubstr("c.toml:2:5 (it must be a finite number)"));
}

TEST(StrictConfig, ReportsNumbersAsWritten) {
  Config c("a = 0.006\nb = 500.0\nc = 7\n", "c.toml");
  for (const char* key : {"a", "b", "c"}) c.require<double>(key, {1.0, 5.0, "s"});
  const std::string s = sentence_of(c);
  EXPECT_THAT(s, HasSubstr("a = 0.006 at"));
  EXPECT_THAT(s, HasSubstr("b = 500.0 at"));
  EXPECT_THAT(s, HasSubstr("c = 7 at"));
}

TEST(StrictConfig, ReadsBranchesInAnyCaseOnRequest) {
  Config c("a = 'genrou'\nb = 'genrou'\nc = 'GENROX'\n", "c.toml");
  const Branch machines{.words = {"GENCLS", "GENROU"}, .any_case = true};
  EXPECT_EQ(c.branch("a", machines), "genrou");
  c.branch("b", {.words = {"GENROU"}});
  c.branch("c", machines);
  const std::string s = sentence_of(c);
  EXPECT_THAT(s, Not(HasSubstr("a = 'genrou'")));
  EXPECT_THAT(s, HasSubstr("b = 'genrou'"));
  EXPECT_THAT(s, HasSubstr("did you mean GENROU"));
}

TEST(StrictConfig, RefusesExcludedKeys) {
  Config c("size = 1\nnumber = 2\n", "c.toml");
  c.require<double>("size");
  c.exclude("number", "two sizes", "size gives another", "leave one out");
  c.exclude("absent", "two sizes", "size gives another", "leave one out");
  EXPECT_EQ(sentence_of(c), "two sizes at c.toml:2:10 (size gives another): leave one out");
}

TEST(StrictConfig, SyntaxErrorNamesItsLine) {
  try {
    Config c("a = 1\nb = \n", "c.toml");
    FAIL() << "nothing thrown";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("not TOML at c.toml:2:"));
  }
}

TEST(StrictConfig, MissingFileIsNamed) {
  EXPECT_THROW(Config(std::filesystem::path("/nonexistent/x.toml")), InputError);
  Config c("raw = 'no.raw'\n", "folder/c.toml");
  c.file("raw");
  EXPECT_THAT(sentence_of(c), HasSubstr("there is no file folder/no.raw"));
}

}  // namespace
}  // namespace swingbank
