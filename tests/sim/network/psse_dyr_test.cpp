#include <gmock/gmock.h>

#include "tests/sim/network/raw_case.hpp"

namespace swingbank::sim {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<DyrRecord> read(const std::string& text) {
  const ScratchFile file("case.dyr", text);
  return read_dyr(file.path);
}

TEST(PsseDyr, RecordsSpanLinesAndEndAtASlash) {
  const auto r = read(
      "/ a comment line\n\n  101 'GENCLS' 1   3.5  0.0 / infinite bus, nearly\n102, genrou, '2 ' 8.0 "
      "0.3E-01\n   0.4D0,\n  -1\n/\n103 \"X Y\" A1 /");
  ASSERT_EQ(r.size(), 3u);
  EXPECT_EQ(r[0].bus, 101);
  EXPECT_EQ(r[0].model, "GENCLS");
  EXPECT_EQ(r[0].id, "1");
  EXPECT_THAT(r[0].values, ElementsAre(3.5, 0.0));
  EXPECT_EQ(r[0].line, 3);
  EXPECT_EQ(r[1].model, "GENROU");
  EXPECT_EQ(r[1].id, "2");
  EXPECT_THAT(r[1].values, ElementsAre(8.0, 0.03, 0.4, -1.0));
  EXPECT_EQ(r[1].line, 4);
  EXPECT_EQ(r[2].model, "X Y");
  EXPECT_EQ(r[2].id, "A1");
  EXPECT_TRUE(r[2].values.empty());
}

TEST(PsseDyr, EveryFaultIsReportedAtOnceWithItsLine) {
  const auto problems = problems_of([] {
    read(
        "101 'GENCLS' 1 3.5 nan /\nx 'GENCLS' 1 1 0 /\n103 /\n104 'GENCLS' 1 1,,2 /\n105 'GENCLS 1 1 /\n106 "
        "'GENCLS' 1 3.0\n 0.0\n");
  });
  std::string all;
  for (const Problem& p : problems) all += p.sentence() + "\n";
  EXPECT_THAT(all, HasSubstr("GENCLS parameter 2 = 'nan' at "));
  EXPECT_THAT(all, HasSubstr("case.dyr:1"));
  EXPECT_THAT(all, HasSubstr("bus number = 'x'"));
  EXPECT_THAT(all, HasSubstr("case.dyr:2"));
  EXPECT_THAT(all, HasSubstr("incomplete record"));
  EXPECT_THAT(all, HasSubstr("case.dyr:3"));
  EXPECT_THAT(all, HasSubstr("GENCLS parameter 2 is missing"));
  EXPECT_THAT(all, HasSubstr("case.dyr:4"));
  EXPECT_THAT(all, HasSubstr("a quote is not closed"));
  EXPECT_THAT(all, HasSubstr("case.dyr:5"));
  EXPECT_THAT(all, HasSubstr("a record has no end"));
}

TEST(PsseDyr, AMissingFileIsNamed) {
  EXPECT_THAT(sentences_of([] { read_dyr("/nowhere/case.dyr"); }), HasSubstr("/nowhere/case.dyr"));
}

}  // namespace
}  // namespace swingbank::sim
