// Files of another kind or version than expected, and numbers as nearest doubles.
#include <gmock/gmock.h>

#include <cstdlib>
#include <random>

#include "sim/formats/psse_text.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kDyr = "// machines\n101 'GENCLS' 1 3 0 /\n102 'GENCLS' 1 3 0 /\n";

std::vector<std::string> sentences(const std::string& raw, const std::string& dyr) {
  const ScratchFile network("a.raw", raw), dynamics("a.dyr", dyr);
  std::vector<std::string> all;
  for (const Problem& p : problems_of([&] { refuse_exchanged(network.path, dynamics.path); }))
    all.push_back(p.sentence());
  return all;
}

TEST(PsseKind, ReportsExchangedFilesInOneSentence) {
  const std::string raw = RawCase().text();
  EXPECT_THAT(sentences(raw, kDyr), ElementsAre());
  EXPECT_THAT(sentences(kDyr, raw), ElementsAre(HasSubstr("exchange --raw and --dyr")));
  EXPECT_THAT(sentences(kDyr, kDyr), ElementsAre(AllOf(HasSubstr("not a .raw file"), HasSubstr("'GENCLS'"))));
  EXPECT_THAT(sentences(raw, raw), ElementsAre(HasSubstr("not a .dyr file")));
  EXPECT_THAT(sentences("{\"network\": {}}", kDyr), ElementsAre());
  EXPECT_THAT(sentences(kDyr, "{\"network\": {}}"), ElementsAre(HasSubstr("exchange")));
  EXPECT_THAT(sentences(raw, "'DC 1' 'CDC6T' 1 2 /\n"), ElementsAre());
  for (const char* nothing : {"", "\n\n", "// only a comment\n"})  // reported by their readers
    EXPECT_THAT(sentences(nothing, nothing), ElementsAre());
}

/// Network of version 33 with another version in its header.
TEST(PsseKind, ReportsAWrongVersionWithTheRightOne) {
  RawCase c;
  for (int k = 0; k < 30; ++k)
    c.branches += "101,102,'" + std::to_string(10 + k) + "',0.01,0.12,0,250,250,250,0,0,0,0,1,1,0,1,1\n";
  const std::string text = c.text();
  const auto without_version = [&] {
    std::string t = text;
    return t.replace(t.find("33"), 2, "");
  }();
  const auto faults = [](const std::string& t, const RawOptions& options) {
    return problems_of([&] { parse_raw(t, "case.raw", options); });
  };
  EXPECT_TRUE(faults(without_version, {60.0, 33}).empty());
  const auto wrong = faults(without_version, {60.0, 23});
  ASSERT_EQ(wrong.size(), 1u);
  EXPECT_THAT(wrong[0].sentence(), AllOf(HasSubstr("errors when read as version 23"),
                                         HasSubstr("it has none"), HasSubstr("--raw-version 33")));
  std::string header = text;
  header.replace(header.find("33"), 2, "23");
  const auto said = faults(header, {});
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0].remedy, AllOf(HasSubstr("REV"), HasSubstr("33")));
  EXPECT_EQ(problems_of([&] { parse_raw_survey(header, "case.raw"); }).size(), 1u);
}

/// A decimal is read as the nearest double, which rounding through extended precision may miss, and written
/// back with no more digits.
TEST(PsseKind, NumbersAreNearestDoublesAndAreWrittenAsShort) {
  std::mt19937_64 random(7);
  int differ = 0;
  for (int k = 0; k < 20000; ++k) {
    const std::string text = "0.0" + std::to_string(1 + random() % 999999999);
    const auto read = psse::parse_number(text);
    ASSERT_TRUE(read);
    const double nearest = std::strtod(text.c_str(), nullptr);
    ASSERT_EQ(static_cast<double>(*read), nearest) << text;
    if (static_cast<double>(std::strtold(text.c_str(), nullptr)) != nearest) ++differ;
    ASSERT_LE(psse::shortest(nearest).size(), text.size()) << psse::shortest(nearest) << " of " << text;
  }
  EXPECT_GT(differ, 0) << "no number for which rounding through extended precision misses the nearest double";
  EXPECT_EQ(psse::shortest(0.006), "0.006");
}

}  // namespace
}  // namespace swingbank::sim::formats
