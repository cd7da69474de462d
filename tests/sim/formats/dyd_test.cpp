// PSLF .dyd: records as written by PSLF and by hand, converted to the form of a .dyr and back.
#include "sim/formats/dyd.hpp"

#include <gmock/gmock.h>

namespace swingbank::sim::formats {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pointwise;

// Values and layout of PSLTDSim's cases of six and four machines.
const std::string kNamed =
    R"(genrou   1 "GEN1" 22.00 "1 " : #9 mva=900.00 "tpdo" 6.50 "tppdo" 0.079 "tpqo" 0.53 "tppqo" 0.072 )"
    R"("h" 4 "d" 0.0 "ld" 1.24 "lq" 1.22 "lpd" 0.23 "lpq" 0.36 "lppd" 0.17 "ll" 0.14 "s1" 0.173 )"
    R"("s12" 0.447 "ra" 0.003 "rcomp" 0.0 "xcomp" 0.0 "accel" 1.0)"
    "\n";

std::string faults(const DydSurvey& s) {
  std::string text;
  for (const auto& p : s.dyr.faults) text += p.sentence() + "\n";
  for (const auto& r : s.dyr.records)
    for (const auto& p : r.faults.list()) text += p.sentence() + "\n";
  return text;
}

TEST(Dyd, NamedAndUnnamedValuesAreTheSame) {
  const DydSurvey named = parse_dyd_survey("# a comment\nlodrep\nmodels\n" + kNamed, "a.dyd");
  EXPECT_EQ(faults(named), "");
  ASSERT_EQ(named.dyr.records.size(), 1U);
  const DyrRecord& r = named.dyr.records[0];
  EXPECT_EQ(r.model, "GENROU");
  EXPECT_EQ(r.bus, 1);
  EXPECT_EQ(r.id, "1");
  EXPECT_EQ(r.line, 4);
  EXPECT_THAT(r.values,
              ElementsAre(6.5, 0.079, 0.53, 0.072, 4, 0, 1.24, 1.22, 0.23, 0.36, 0.17, 0.14, 0.173, 0.447));
  EXPECT_EQ(named.machines.at(4).mva, 900);
  EXPECT_EQ(named.machines.at(4).resistance, 0.003);
  const DydSurvey plain = parse_dyd_survey(
      "genrou 1 \"GEN1\" 22.00 \"1 \" : #9 mva=900.00 6.50 0.079 0.53 0.072 4 0.0 1.24 /\n"
      "  1.22 0.23 0.36 0.17 0.14 0.173 0.447 0.003 0.0 0.0 1.0\n",
      "b.dyd");
  EXPECT_EQ(faults(plain), "");
  EXPECT_EQ(plain.dyr.records.at(0).values, r.values);
}

TEST(Dyd, ConvertsTurbineRatingToTheMachineBase) {
  const DydSurvey s = parse_dyd_survey(
      kNamed + "tgov1 1 \"GEN1\" 22.00 \"1 \" : #1 mwcap=450.0 0.05 0.4 1.0 0.0 3.0 10.0 0.2\n", "c.dyd");
  EXPECT_EQ(faults(s), "");
  EXPECT_THAT(s.dyr.records.at(1).values, Pointwise(DoubleNear(1e-12), {0.1, 0.4, 0.5, 0.0, 3.0, 10.0, 0.1}));
  EXPECT_THAT(s.notes.at(2), HasSubstr("450 MW"));
}

TEST(Dyd, RefusesActiveParametersWithoutCounterpart) {
  std::string text = kNamed;
  text.replace(text.find("\"xcomp\" 0.0"), 11, "\"xcomp\" -0.06");
  EXPECT_THAT(faults(parse_dyd_survey(text, "d.dyd")), HasSubstr("xcomp = -0.06 of genrou at d.dyd:1"));
  const std::string sexs = "sexs 1 \"GEN1\" 22.00 \"1 \" : #1 0.1 10.0 100.0 0.05 -5.0 5.0 0.08 ";
  EXPECT_EQ(faults(parse_dyd_survey(sexs + "0.0 -5.0 5.0 0.0\n", "e.dyd")), "");
  EXPECT_THAT(faults(parse_dyd_survey(sexs + "0.5 -5.0 4.0 0.0\n", "e.dyd")),
              AllOf(HasSubstr("tc = 0.5"), HasSubstr("efdmax = 4")));
}

TEST(Dyd, Oel1FollowsTheOrderOfThePublicFile) {
  const DydSurvey s =
      parse_dyd_survey("oel1     1 \"GEN1\" 22.00 \"1 \" : #0 2.8 4.0 10 100 5 60 2.5 0 1\n", "o.dyd");
  EXPECT_EQ(faults(s), "");
  EXPECT_EQ(s.dyr.records.at(0).model, "OEL1");
  EXPECT_THAT(s.dyr.records.at(0).values, ElementsAre(2.8, 4, 10, 100, 5, 60, 2.5, 0, 1));
}

TEST(Dyd, RefusesRexsWithItsUnmodelledOptions) {
  const std::string values =
      "0.02 350 0 1 0.02 0 0 0 0 47 -20 0.05 1 0 0 1 1 0 0 47 -20 0 1 1.2 0.05 2 3 0.1 4 0.3 0 0 1.2 0 1 ";
  const std::string begin = "rexs 1 \"GEN1\" 22.00 \"1 \" : #9 ";
  const DydSurvey off = parse_dyd_survey(begin + values + "0 2 0 0\n", "r.dyd");
  EXPECT_EQ(faults(off), "");  // NVPHZ and VCMAX without their gains
  EXPECT_EQ(off.dyr.records.at(0).model, "REXSYS");
  EXPECT_EQ(off.dyr.records.at(0).values.at(30), 1);
  EXPECT_THAT(
      faults(parse_dyd_survey(begin + values + "0.1 2 0.5 0\n", "r.dyd")),
      AllOf(HasSubstr("xc = 0.1 of rexs at r.dyd:1"), HasSubstr("vcmax = 2"), HasSubstr("kefd = 0.5")));
}

TEST(Dyd, ErrorsNameTheirLine) {
  const std::string all = faults(parse_dyd_survey(
      "genrou 1 \"GEN1\" 22.00 \"1 \" : #9 6.5 x\nhygov 1 \"G\" 22 \"1\" : #9 .05 .5 7\ngenrou GEN1 : 1\n",
      "f.dyd"));
  EXPECT_THAT(all, HasSubstr("'x' of genrou at f.dyd:1"));
  EXPECT_THAT(all, HasSubstr("tf of hygov is missing at f.dyd:2"));
  EXPECT_THAT(all, HasSubstr("a record without bus and id at f.dyd:3"));
}

TEST(Dyd, SkipsMetersAndLoadsAndKeepsOthers) {
  const DydSurvey s = parse_dyd_survey(
      "fmeta 1 \"1\" 22.00 \"1 \" : #9 0 1\nimetr 6 ! ! ! 7 ! ! ! : #9 0\nccbt1 1 \"1\" 22.00 \"1 \" : #9 mwcap=12.5 1 2\n",
      "g.dyd");
  EXPECT_THAT(s.dyr.faults, IsEmpty());
  ASSERT_EQ(s.dyr.records.size(), 1U);
  EXPECT_EQ(s.dyr.records[0].model, "CCBT1");
  EXPECT_THAT(s.dyr.records[0].values, ElementsAre(1, 2));
}

TEST(Dyd, RecordsAreChosenByEitherName) {
  const std::string governor = "tgov1 1 \"GEN1\" 22.00 \"1 \" : #1 mwcap=900 0.05 0.4 1.0 0.0 3.0 10.0 0.2\n";
  const DydSurvey s = parse_dyd_survey(kNamed + governor +
                                           "ccbt1 1 \"1\" 22.00 \"1 \" : #9 1 2\n"
                                           "cmpldw 1 \"1\" 22.00 \"1 \" : #9 1\n",
                                       "h.dyd");
  EXPECT_THAT(s.passed_over, ElementsAre(testing::Pair("cmpldw", 1)));
  const auto all = chosen_records(s, "h.dyd", {});
  ASSERT_EQ(all.size(), 3U);
  EXPECT_THAT(all[2].faults.list().at(0).sentence(), HasSubstr("PSLF's model ccbt1 at h.dyd:3"));
  DyrOptions options{{"tgov1"}, {{"CCBT1", "LCFB1"}}};
  const auto chosen = chosen_records(s, "h.dyd", options);
  ASSERT_EQ(chosen.size(), 2U);
  EXPECT_EQ(chosen[1].model, "LCFB1");
  EXPECT_TRUE(chosen[1].faults.empty());
  EXPECT_THAT(
      [&] {
        options.ignore = {"sexs"};
        (void)chosen_records(s, "h.dyd", options);
      },
      testing::ThrowsMessage<InputError>(HasSubstr("no model SEXS to ignore or map at h.dyd")));
}

/// Every model is written and read back with the same values.
TEST(Dyd, RoundTripKeepsAllValues) {
  const std::string dyr =
      "7 'GENROU' 1 6.5 0.079 0.53 0.072 4 0 1.24 1.22 0.23 0.36 0.17 0.14 0.173 0.447 /\n"
      "8 'GENTPJU1' 1 8.9 0.04 0 0.08 3.8 0.5 0.85 0.61 0.22 0.61 0.18 0.18 0.14 0.163 0.378 0.08 /\n"
      "9 'GENCLS' 1 3 0.5 /\n"
      "7 'ESST4B' 1 0.02 3.15 3.15 1 -0.87 0.01 1 0.1 1.1 -0.8 0.2 6.5 0.3 8 0.08 0.04 5 /\n"
      "8 'EXST1' 1 0.01 0.2 -0.2 1 10 200 0.02 5 -4 0.05 0.1 1 /\n"
      "9 'SEXS' 1 0.1 10 100 0.05 -4 5 /\n"
      "7 'REXSYS' 1 0.028 350 2 0.4 0.02 1 2 3 4 101.6 -98 0.0487 2 0.5 0.6 1 1.5 0.7 0.02 99 -97 0.1 1 0.55 0.06 "
      "0.3 3.06 0.1 4.08 0.3 1 /\n"
      "7 'TGOV1' 1 0.05 0.4 1 0 3 10 0.1 /\n"
      "8 'IEEEG1' 1 0 0 20.8 0.2 0.1 0.2 0.4 -0.4 1 0 0.2 0.25 0 2 0.75 0 0.3 0 0 0.1 0 0 /\n"
      "9 'GGOV1' 1 1 0 0.043 5 0.025 -0.025 4.2 0.6 0.1 1 1 0.15 0.2 1.5 0.18 0.9 0.8 0.1 4 1 3.3 1 0.2 99 -99 "
      "0.01 98 10 1 186 0.0006 1 1.1 99 -98 /\n"
      "7 'HYGOV' 1 0.05 0.5 7 0.05 0.2 0.07 1 0 2 1.1 0.5 0.1 /\n"
      "7 'IEEEST' 1 1 0 0.1 0.2 0.3 0.4 0.5 0.6 0.2 0.02 0.5 0.05 1 15 30 0.05 -0.06 0 0 /\n"
      "8 'PSS2A' 1 1 0 3 0 5 1 2 2.1 0.3 2.2 0 2 0.2 1 0.5 0.1 10 0.25 0.04 0.2 0.03 0.1 -0.2 /\n"
      "7 'OEL1' 1 2.8 4 -10 100 5 60 2.5 1 0 /\n";
  const auto records = parse_dyr(dyr, "out.dyr");
  Problems problems;
  std::string text;
  for (const DyrRecord& r : records)
    text += dyd_line(r, {900, 0.003, 0.25}, {"BUS", 22}, "out.dyd", problems);
  EXPECT_TRUE(problems.empty());
  const DydSurvey back = parse_dyd_survey(text, "back.dyd");
  EXPECT_EQ(faults(back), "") << text;
  ASSERT_EQ(back.dyr.records.size(), records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    EXPECT_EQ(back.dyr.records[i].model, records[i].model);
    EXPECT_EQ(back.dyr.records[i].bus, records[i].bus);
    EXPECT_EQ(back.dyr.records[i].values, records[i].values) << records[i].model;
  }
  EXPECT_EQ(back.machines.at(3).reactance, 0.25);
  EXPECT_EQ(back.machines.at(1).resistance, 0.003);
  Problems none;
  dyd_line({1, "IEEEX9", "1", {}, 1}, {}, {}, "x.dyd", none);
  EXPECT_THAT(none.list().at(0).sentence(), HasSubstr("it has no PSLF counterpart"));
}

}  // namespace
}  // namespace swingbank::sim::formats
