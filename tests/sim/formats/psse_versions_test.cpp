// One network in every version of the format; additions of versions 34 and 35, and refusals.
#include <gmock/gmock.h>

#include <algorithm>

#include "sim/network/tie.hpp"
#include "tests/sim/formats/flatten.hpp"
#include "tests/sim/formats/raw_case.hpp"
#include "tests/sim/formats/write_raw.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::HasSubstr;

/// Two machines, two loads, lines, transformers of two and three windings, shunts. Columns that differ
/// between versions have values that are invalid for their neighbours.
std::string text(int version, const std::string& load_extra = "", const std::string& substation = "") {
  const bool v34 = version >= 34, v35 = version >= 35;
  const std::string rates = v34 ? "211,212,213,214,215,216,217,218,219,220,221,222" : "211,212,213";
  const auto begin = [&](const std::string& ended, const std::string& begun) {
    return "0 / END OF " + ended + " DATA" + (v34 ? ", BEGIN " + begun + " DATA" : "") + "\n";
  };
  const auto labels = [&](const std::string& names) { return v34 ? "@!  " + names + "\n" : ""; };
  std::string t = labels("IC,SBASE,REV,XFRRAT,NXFRAT,BASFRQ") + "0, 200.0, " + std::to_string(version) +
                  ", 0, 1, 50.0 / written by hand\ntitle, one\ntitle 'two\n";
  if (v34)
    t += "GENERAL, THRSHZ=0.0001, PQBRAK=0.7, BLOWUP=5.0\nGAUSS, ITMX=100, ACCP=1.6\nNEWTON, ITMXN=20\n"
         "RATING, 1, \"RATE1 \", \"RATING SET 1, SUMMER\"\n" +
         begin("SYSTEM-WIDE", "BUS");
  t += labels("I,'NAME', BASKV, IDE,AREA,ZONE,OWNER, VM, VA, NVHI, NVLO, EVHI, EVLO");
  t += "11,'WEST, OLD   ', 20.0,3,1,1,1,1.02,0.0\n12,'EAST', 110.0,2,1,1,1,1.01,-3.5\n"
       "13,'SOUTH',110.0,1,1,1,1,0.98,-7.0\n14,'LOW',10.0,1,1,1,1,0.97,-9.0\n15,'OFF',110.0,4\n";
  t +=
      begin("BUS", "LOAD") + labels("I,'ID',STAT,AREA,ZONE,PL,QL,IP,IQ,YP,YQ,OWNER,SCALE,INTRPT,DGENP,DGENQ");
  const std::string extra = v35 ? ",0,0,0,'SPECIAL'" : v34 ? ",0,0,0" : "";
  t += "13,'1',1,2,2,120.0,40.0,5.0,2.0,3.0,-1.0,1,1,0" + (load_extra.empty() ? extra : load_extra) + "\n";
  t += "14,'A',1,2,2,30.0,10.0,0,0,0,0,1,1,0" + extra + "\n";
  t += begin("LOAD", "FIXED SHUNT") + "13,'1',1,2.0,30.0\n" + begin("FIXED SHUNT", "GENERATOR");
  const std::string node = v35 ? ",7" : "", base_load = v35 ? ",2" : "";
  t += "11,'1',90.0,20.0,80.0,-60.0,1.02,0" + node + ",150.0,0.002,0.21,0,0,1.0,1,100.0,140.0,10.0" +
       base_load + ",1,1.0,0,1.0,0,1.0,0,1.0,0,1.0" + (version == 34 ? ",7" : "") + "\n";
  t += "12,'G2',70.0,5.0,50.0,-40.0,1.01,12" + node + ",130.0,0.001,0.25,0,0,1.0,1,100.0,120.0,0.0" +
       base_load + ",1,1.0\n";
  t += begin("GENERATOR", "BRANCH");
  const std::string rating = v34 ? "'LINE, NORTH 1'," + rates : rates;
  t += "12,-13,'1',0.01,0.08,0.03," + rating + ",0.001,0.002,0.003,0.004,1,1,12.5,1,1.0\n";
  t += "12,13,'2',0.02,0.16,0.06," + rating + ",0,0,0,0,0,2,25.0,1,1.0\n";
  if (!v34) t += "13,15,'@1',0,0.0004,0,0,0,0,0,0,0,0,1\n";  // earlier versions list a switch among the lines
  t += begin("BRANCH", v34 ? "SYSTEM SWITCHING DEVICE" : "TRANSFORMER");
  if (v34)
    t += labels("I,J,'CKT',X,RATE1,STAT,NSTAT,MET,STYPE,'NAME'") + "13,15,'@1',0.0004," + rates +
         ",1,1,2,2,'BREAKER'\n" + begin("SYSTEM SWITCHING DEVICE", "TRANSFORMER");
  const std::string group = version >= 33 ? ",'YNd5, TYPE'" : "", code = v35 ? ",0" : "";
  const std::string cod = v35 ? ",-1,12,3" : ",-1,12", last = version == 34 ? ",3" : "";
  const auto winding = [&](const std::string& values) {
    return values + "," + rates + cod + ",1.1,0.9,1.05,0.95,33,0,0.01,0.02" + (version >= 33 ? ",0.0" : "") +
           last + "\n";
  };
  t += "11,12,0,'T1',1,2,1,0.001,-0.004,2,'STEP-UP, UNIT 1',1,1,1.0,0,1.0,0,1.0,0,1.0" + group + code + "\n" +
       "0.004,0.11,150.0\n" + winding("1.05,0.0,30.0") + "0.98,0.0\n";
  t += "12,13,14,'T3',1,1,1,0.002,-0.006,2,'TERTIARY',1,1,1.0,0,1.0,0,1.0,0,1.0" + group + code + "\n" +
       "0.002,0.08,200.0,0.004,0.14,200.0,0.003,0.12,200.0,0.99,-5.0\n" + winding("1.02,0.0,0.0") +
       winding("0.99,0.0,0.0") + winding("1.0,0.0,-30.0");
  t += begin("TRANSFORMER", "AREA") + "1,11,0.0,10.0,'AREA, ONE'\n" + begin("AREA", "TWO-TERMINAL DC");
  t += begin("TWO-TERMINAL DC", "VSC DC LINE") + begin("VSC DC LINE", "IMPEDANCE CORRECTION");
  t += begin("IMPEDANCE CORRECTION", "MULTI-TERMINAL DC") + begin("MULTI-TERMINAL DC", "MULTI-SECTION LINE");
  t += begin("MULTI-SECTION LINE", "ZONE") + "2,'ZONE'\n" + begin("ZONE", "INTER-AREA TRANSFER");
  t += begin("INTER-AREA TRANSFER", "OWNER") + begin("OWNER", "FACTS DEVICE");
  t += begin("FACTS DEVICE", "SWITCHED SHUNT");
  t += v35             ? "14,'1',1,0,1,1.1,0.9,14,0,100.0,'',12.5,1,2,6.25\n"
       : version == 34 ? "14,1,0,1,1.1,0.9,14,100.0,'',12.5,2,6.25,0\n"
                       : "14,1,0,1,1.1,0.9,14,100.0,'',12.5,2,6.25\n";
  t += begin("SWITCHED SHUNT", "GNE") + begin("GNE", "INDUCTION MACHINE");
  if (version >= 33) t += begin("INDUCTION MACHINE", "SUBSTATION");
  if (v34) t += substation + begin("SUBSTATION", "NOTHING");
  return t + "Q\nwhat follows the end is not read\n";
}

class PsseVersions : public ::testing::TestWithParam<int> {};
TEST_P(PsseVersions, HoldTheSameNetwork) {
  const network::Network n = parse_raw(text(GetParam()), "case.raw");
  expect_same(parse_raw(text(33), "case.raw"), n);
  EXPECT_EQ(n.title, "title, one\ntitle 'two");
  EXPECT_EQ(n.buses.size(), 6u);  // one is the star point
  ASSERT_EQ(n.branches.size(), 7u);
  EXPECT_EQ(n.branches[0].shunt_from, Complex(0.001, 0.002));
  EXPECT_EQ(n.branches[0].shunt_to, Complex(0.003, 0.004));
  EXPECT_FALSE(n.branches[1].in_service);
  EXPECT_EQ(n.branches[2].x, 0.0004);      // the switch
  EXPECT_FALSE(n.branches[2].in_service);  // connects an isolated bus
  ASSERT_EQ(n.generators.size(), 2u);
  EXPECT_EQ(n.generators[0].mva, 150.0);
  EXPECT_EQ(n.generators[0].zr, 0.002);
  EXPECT_EQ(n.generators[0].zx, 0.21);
  ASSERT_EQ(n.shunts.size(), 2u);
  EXPECT_EQ(n.shunts[1].admittance, Complex(0.0, 0.0625));
}
TEST_P(PsseVersions, WriteBackToTheLastBit) {
  const network::Network n = parse_raw(text(GetParam()), "case.raw");
  for (const int version : {32, 33, 34, 35}) expect_same(n, parse_raw(raw_text(n, version), "out.raw"));
}
INSTANTIATE_TEST_SUITE_P(All, PsseVersions, ::testing::Values(32, 33, 34, 35));

TEST(PsseVersion35, DistinguishesSwitchedShuntsOfOneBus) {
  std::string t = text(35);
  const std::string first = "14,'1',1,0,1,1.1,0.9,14,0,100.0,'',12.5,1,2,6.25\n";
  t.replace(t.find(first), first.size(), first + "14,'2',1,0,1,1.1,0.9,14,0,100.0,'',-5.0\n");
  const network::Network n = parse_raw(t, "case.raw");
  ASSERT_EQ(n.shunts.size(), 3u);
  EXPECT_NE(n.shunts[1].id, n.shunts[2].id);
  ASSERT_EQ(n.switched.size(), 1u);  // the other switched shunt has no blocks
  EXPECT_EQ(n.switched[0].steps, (std::vector<double>{0.0, 0.03125, 0.0625}));
  EXPECT_EQ(n.switched[0].most, 1.1);
  expect_same(n, parse_raw(raw_text(n, 33), "out.raw"));
}

TEST(PsseVersion34, SubtractsDistributedGenerationFromTheLoad) {
  const std::string running = ",8.0,1.0,1", off = ",8.0,1.0,0";
  const network::Network with = parse_raw(text(34, running), "case.raw"), without = parse_raw(text(34), "a");
  const auto difference = without.loads[0].power - with.loads[0].power;
  EXPECT_NEAR(std::abs(difference - Complex(8.0, 1.0) / without.base_mva), 0.0, 1e-15);
  ASSERT_EQ(with.remarks.size(), without.remarks.size() + 1);
  expect_same(without, parse_raw(text(34, off), "b"));
}

TEST(PsseVersion34, AFileMayLackSystemWideDataAndSwitches) {
  std::string t = text(34);
  const auto cut = [&](const std::string& from, const std::string& to) {
    const auto a = t.find(from), b = t.find(to);
    ASSERT_NE(a, std::string::npos);
    t.erase(a, b - a);
  };
  cut("GENERAL", "@!  I,'NAME'");
  cut("0 / END OF BRANCH DATA", "0 / END OF SYSTEM SWITCHING");
  const std::string separator = "0 / END OF SYSTEM SWITCHING DEVICE DATA, BEGIN TRANSFORMER DATA";
  t.replace(t.find(separator), separator.size(), "0 / END OF BRANCH DATA, BEGIN TRANSFORMER DATA");
  EXPECT_EQ(parse_raw(t, "case.raw").branches.size(), 6u);
}

std::string station(const std::string& status, const std::string& second_bus = "13") {
  return "1,'STATION, ONE',0.0,0.0,0.1\n  /  BEGIN SUBSTATION NODE DATA\n@! NI,'NAME',I,STATUS,VM,VA\n"
         "1,'N1',13,1,1.0,0.0\n2,'N2'," +
         second_bus +
         ",1,1.0,0.0\n3,'N3',13,1,1.0,0.0\n"
         "0 / END OF SUBSTATION NODE DATA, BEGIN SUBSTATION SWITCHING DEVICE DATA\n"
         "1,2,'1','SWITCH','2'," +
         status +
         ",1,0.0,0.0,0.0,0.0\n2,3,'1','SWITCH','2',1,1,0.0,0.0,0.0,0.0\n"
         "0 / END OF SUBSTATION SWITCHING DEVICE DATA, BEGIN SUBSTATION TERMINAL DATA\n"
         "13,1,'B',12,'1'\n13,2,'L','1'\n0 / END OF SUBSTATION TERMINAL DATA\n";
}
TEST(PsseSubstation, ChangesNothing_WhenItsBusesAreConnected) {
  for (const int version : {34, 35})
    expect_same(parse_raw(text(version), "a"),
                parse_raw(text(version, "", station("1") + station("1")), "b"));
}
TEST(PsseSubstation, RefusesSplitAndJoinedBuses) {
  const std::string split = text(35, "", station("0")), joined = text(35, "", station("1", "12"));
  EXPECT_THAT(
      sentences_of([&] { parse_raw(split, "case.raw"); }),
      HasSubstr("open switches split bus 13 at case.raw:" + std::to_string(line_of(split, "13,2,'L'"))));
  EXPECT_THAT(sentences_of([&] { parse_raw(joined, "case.raw"); }),
              HasSubstr("closed switches join buses 13 and 12 at case.raw:"));
}
TEST(PsseSubstation, ReportsErrorsWithTheirLine) {
  const std::string t =
      text(35, "", "1,'S',0,0,0.1\n1,'N',13,1\n1,'N',77,1\n0\n1,9,'1','X','2',1\n0\n13,8,'L','1'\n0\n");
  const std::string all = sentences_of([&] { parse_raw(t, "case.raw"); });
  EXPECT_THAT(all, HasSubstr("node 1 appears twice at case.raw:" + std::to_string(line_of(t, "1,'N',77"))));
  EXPECT_THAT(all, HasSubstr("bus 77 is not in the bus section"));
  EXPECT_THAT(all, HasSubstr("node 9 is not in the substation's nodes"));
  EXPECT_THAT(all, HasSubstr("node 8 is not in the substation's nodes"));
}

TEST(PsseSwitch, ReportsErrorsWithTheirLine) {
  std::string t = text(35);
  const std::string good = "13,15,'@1',0.0004,";
  t.replace(t.find(good), good.size(), "13,13,'@1',0.0,");
  const std::string all = sentences_of([&] { parse_raw(t, "case.raw"); });
  const std::string where = " at case.raw:" + std::to_string(line_of(t, "13,13,'@1'"));
  EXPECT_THAT(all, HasSubstr("a switch from bus 13 to itself" + where));
}

TEST(PsseSwitch, GetsTheLeastImpedance_WithoutReactance) {
  std::string t = text(35);
  const std::string good = "13,15,'@1',0.0004,";
  t.replace(t.find(good), good.size(), "13,15,'@1',0.0,");
  const network::Network n = parse_raw(t, "case.raw");
  EXPECT_EQ(n.branches[2].x, network::kLeastImpedance);
  const auto said = std::ranges::find_if(n.remarks, [](const network::Remark& r) {
    return r.what.find("zero-impedance branches") != std::string::npos;
  });
  ASSERT_NE(said, n.remarks.end());
  EXPECT_THAT(
      said->places,
      ::testing::ElementsAre("13-15 circuit @1 (case.raw:" + std::to_string(line_of(t, "13,15,'@1'")) + ")"));
}

TEST(PsseRawText, BasesBeyondTheRangeOfNumbersAreRefused) {
  RawCase c;
  std::string t = c.text();
  t.replace(t.find("100.0"), 5, "1e-300");
  t.replace(t.find("250.0,30.0"), 10, "1e300,30.0");
  EXPECT_THAT(sentences_of([&] { parse_raw(t, "case.raw"); }), HasSubstr("has a value that is not finite"));
}

}  // namespace
}  // namespace swingbank::sim::formats
