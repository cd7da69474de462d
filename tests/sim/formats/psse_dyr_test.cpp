#include <gmock/gmock.h>

#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<DyrRecord> read(const std::string& text, const DyrOptions& options = {}) {
  const ScratchFile file("case.dyr", text);
  return read_dyr(file.path, options);
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

TEST(PsseDyr, ReportsAllErrorsWithTheirLines) {
  const auto problems = problems_of([] {
    read(
        "101 'GENCLS' 1 3.5 nan /\nx 'GENCLS' 1 1 0 /\n103 /\n104 'GENCLS' 1 1,x,2 /\n105 'GENCLS 1 1 /\n106 "
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
  EXPECT_THAT(all, HasSubstr("GENCLS parameter 2 = 'x'"));
  EXPECT_THAT(all, HasSubstr("case.dyr:4"));
  EXPECT_THAT(all, HasSubstr("a quote is not closed"));
  EXPECT_THAT(all, HasSubstr("case.dyr:5"));
}

TEST(PsseDyr, EmptyParametersAreZeroAndCounted) {
  const auto r = read("101 'GENCLS' 1,,2.0,,3.0 /\n");
  ASSERT_EQ(r.size(), 1u);
  EXPECT_TRUE(r[0].faults.empty());
  EXPECT_THAT(r[0].values, ElementsAre(0.0, 2.0, 0.0, 3.0));
  EXPECT_THAT(r[0].empty, ElementsAre(1, 3));
}

TEST(PsseDyr, AllowsCommentLinesWithinRecords) {
  const auto r = read(
      "// head\n101 'GENCLS' 1 3.5 // rest / of / line\n102 'GENROU' 1 8.0\n  // inside, 'quote\n0.03 /\n");
  ASSERT_EQ(r.size(), 2u);
  EXPECT_THAT(r[0].values, ElementsAre(3.5));
  EXPECT_THAT(r[1].values, ElementsAre(8.0, 0.03));
}

TEST(PsseDyr, TextInAnUnusedModelIsOnlyNoted) {
  const auto r =
      read("101 'XYZ' 1 2.0 'text' 3.0 /\n102 'USRMDL' 1 'MyGov' 1 1 0 /\n0 'USRMSC' 'MYREL' 512 0 /\n");
  ASSERT_EQ(r.size(), 3u);
  EXPECT_EQ(r[0].texts.size(), 1u);
  EXPECT_EQ(r[1].model, "USRMDL");
  EXPECT_EQ(r[1].user, "MYGOV");
  EXPECT_THAT(r[1].values, ElementsAre(1.0, 1.0, 0.0));
  EXPECT_EQ(r[2].user, "MYREL");
}

TEST(PsseDyr, ModelsAreIgnoredOrMappedByName) {
  const std::string text =
      "101 'GENCLS' 1 3.0 0 /\n101 'IEEEX9' 1 1 2 /\n101 'USRMDL' 1 'MYGOV' 5 0 /\n101 'TGOVX' 1 7 8 /\n";
  DyrOptions options;
  options.ignore = {"ieeex9", "MyGov"};
  Problems problems;
  add_model_map(options, "tgovx=tgov1", "--map-model", problems);
  EXPECT_TRUE(problems.empty());
  const auto r = read(text, options);
  ASSERT_EQ(r.size(), 2u);
  EXPECT_EQ(r[0].model, "GENCLS");
  EXPECT_EQ(r[1].model, "TGOV1");
  EXPECT_THAT(r[1].values, ElementsAre(7.0, 8.0));
  options.map = {{"MYGOV", "TGOV1"}};
  EXPECT_THAT(sentences_of([&] { read(text, options); }), HasSubstr("MYGOV is both ignored and mapped"));
  options = {{"NOTHERE"}, {}};
  EXPECT_THAT(sentences_of([&] { read(text, options); }), HasSubstr("no model NOTHERE to ignore or map"));
  add_model_map(options, "A=B", "--map-model", problems);
  add_model_map(options, "a=C", "--map-model", problems);
  for (const char* bad : {"", "A", "=B", "A="}) add_model_map(options, bad, "--map-model", problems);
  EXPECT_EQ(problems.list().size(), 5u);
}

TEST(PsseDyr, AMissingFileIsNamed) {
  EXPECT_THAT(sentences_of([] { read_dyr("/nowhere/case.dyr"); }), HasSubstr("/nowhere/case.dyr"));
}

TEST(PsseDyr, UnterminatedRecordEndsBeforeTheNext) {
  const auto r =
      parse_dyr("5 'REGCA1' 'S ' 1\n 0.02 10.0\n5 'REECA1' 'S '\n 0 0.5 /\n6 'GENCLS' 1 3.0 0 /\n", "x.dyr");
  ASSERT_EQ(r.size(), 3u);
  EXPECT_TRUE(r[0].unended);
  EXPECT_THAT(r[0].values, ElementsAre(1.0, 0.02, 10.0));
  EXPECT_EQ(r[1].model, "REECA1");
  EXPECT_EQ(r[1].line, 3);
  EXPECT_FALSE(r[1].unended);
}

TEST(PsseDyr, TheLastRecordEndsWithItsFile) {
  const auto r = parse_dyr("6 'GENCLS' 1 3.0 0 /\n7 'GENCLS' 1 4.0\n 0.5\n", "x.dyr");
  ASSERT_EQ(r.size(), 2u);
  EXPECT_FALSE(r[0].unended);
  EXPECT_TRUE(r[1].unended);
  EXPECT_THAT(r[1].values, ElementsAre(4.0, 0.5));
  EXPECT_THAT(sentences_of([] { parse_dyr("6 'GENCLS' 1 3.0 0 /\n7 'GENCLS'\n", "x.dyr"); }),
              HasSubstr("x.dyr:2"));
}

TEST(PsseDyr, RecordsOfEquipmentKeepItsName) {
  const auto r = parse_dyr("'DC LINE 1' 'CDC6T' 1 2 'x' /\n\"V1 \" \"VSCP\" /\n", "x.dyr");
  ASSERT_EQ(r.size(), 2u);
  EXPECT_EQ(r[0].equipment, "DC LINE 1");
  EXPECT_EQ(r[0].model, "CDC6T");
  EXPECT_EQ(r[1].equipment, "V1");
}

/// Some models have text parameters: the reader keeps them, and models with numbers only report them.
TEST(PsseDyr, TextsAmongTheParametersAreKept) {
  const auto r = parse_dyr("7 'MODEL' 1 2 'A1' '3' 4 /\n", "t.dyr");
  ASSERT_EQ(r.size(), 1U);
  EXPECT_THAT(r[0].values, ::testing::ElementsAre(2, 0, 3, 4));
  EXPECT_TRUE(r[0].faults.empty());
  ASSERT_EQ(r[0].texts.size(), 1U);
  EXPECT_EQ(r[0].texts[0].at, 1U);
  EXPECT_THAT(r[0].texts[0].fault.list().at(0).sentence(),
              ::testing::HasSubstr("MODEL parameter 2 = 'A1' at t.dyr:1"));
}

TEST(PsseDyr, ParametersOfUserModelsAreCountedAfterTheName) {
  const auto r = parse_dyr("7 'USRMDL' '1' 'MYGOV' 1 x ,, 2 /\n", "t.dyr");
  ASSERT_EQ(r.size(), 1U);
  EXPECT_THAT(r[0].faults.list().at(0).what, HasSubstr("USRMDL parameter 2"));
  EXPECT_THAT(r[0].empty, ElementsAre(3));
}

TEST(PsseDyr, CtrlZAndQAndZeroEndTheFile) {
  const std::string records = "6 'GENCLS' 1 3.0 0 /\n7 'GENCLS' 1 4.0 0.5 /\n";
  for (const char* last : {"\x1A", "\x1A\n\x1A", "Q", " q \n", "0 /", "0 / END OF DATA\n", "0 /\nQ\n\x1A"}) {
    const auto r = parse_dyr(records + last, "x.dyr");
    ASSERT_EQ(r.size(), 2U) << last;
    EXPECT_THAT(r[1].values, ElementsAre(4.0, 0.5));
  }
  EXPECT_THAT(sentences_of([&] { parse_dyr(records + "0 / END\n" + records, "x.dyr"); }),
              HasSubstr("records after the end mark at x.dyr:4 (line 3 (Q or 0) ends the file)"));
}

TEST(PsseDyr, HashAndExclamationMarkBeginComments) {
  const auto r = parse_dyr(
      "# machines\n6 'GENCLS' 1 3.0 ! H\n  0.5 / # damping\n! next\n'LINE #2' 'CDC6T' 1.0 / !\n", "x.dyr");
  ASSERT_EQ(r.size(), 2U);
  EXPECT_THAT(r[0].values, ElementsAre(3.0, 0.5));
  EXPECT_EQ(r[1].equipment, "LINE #2");
}

TEST(PsseDyr, RepeatCountsAreExpanded) {
  const auto r = parse_dyr("6 'GENROU' 1 2*1.5 1*0.0 3 2*/\n7 'X' '*' 4*x /\n", "x.dyr");
  ASSERT_EQ(r.size(), 2U);
  EXPECT_THAT(r[0].values, ElementsAre(1.5, 1.5, 0.0, 3.0, 0.0, 0.0));
  EXPECT_THAT(r[0].empty, ElementsAre(5, 6));
  EXPECT_EQ(r[1].id, "*");
  EXPECT_FALSE(r[1].faults.empty());
}

TEST(PsseDyr, CountsTheCodesOfUserWrittenModels) {
  const auto r = parse_dyr(
      "2 'USRMDL' 1 'REGCAU1' 101 1 1 14 3 4 1 0.02 /\n3 'USRLOD' 1 'LINJBL' 12 1 4 8 0 5 0 1 /\n"
      "4 'GENCLS' 1 3 0 /\n",
      "x.dyr");
  ASSERT_EQ(r.size(), 3U);
  EXPECT_EQ(r[0].codes, 6U);
  EXPECT_EQ(r[1].codes, 7U);
  EXPECT_EQ(r[2].codes, 0U);
}

}  // namespace
}  // namespace swingbank::sim::formats
