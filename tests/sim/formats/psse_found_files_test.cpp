// Files as found in practice: old versions, missing headers, byte-order marks, repeated sections, branches
// without impedance, correction tables, remote regulation, islands; and .rawx files.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "sim/network/powerflow.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The three-bus grid of RawCase in the layout of a version before 31.
std::string old(int version) {
  const bool old23 = version == 23, tap_in_branch = version < 28;
  std::string t = old23 ? "0, 100.0\n" : "0, 100.0, " + std::to_string(version) + ",0,0,60.0\n";
  t += "first title\nsecond title\n";
  if (old23)
    t += "101,3,0,0,0,0,1,1.05,0.0,'NORTH',138.0,1\n102,2,0,0,0,0,1,1.02,-0.9,'EAST',138.0,1\n"
         "103,1,250.0,30.0,1.0,20.0,1,0.99,-8.7,'SOUTH',138.0,1\n0\n";
  else
    t += "101,'NORTH',138.0,3,0,0,1,1,1.05,0.0,1\n102,'EAST',138.0,2,0,0,1,1,1.02,-0.9,1\n"
         "103,'SOUTH',138.0,1,1.0,20.0,1,1,0.99,-8.7,1\n0\n103,'1',1,1,1,250.0,30.0,0,0,0,0,1\n0\n";
  t += "101,'1',153.0,73.0,100,-100,1.05,0,100,0,0.3,0,0,1,1,100,318,0\n"
       "102,'1',100.0,-3.0,100,-100,1.02,0,100,0,0.25,0,0,1,1,100,318,0\n0\n";
  const std::string tap = tap_in_branch ? ",0.98,5.0" : "";
  t += "101,103,'1',0.01,0.12,0.0,250,250,250" + std::string(tap_in_branch ? ",0,0" : "") + ",0,0,0,0,1\n";
  if (tap_in_branch)
    t += "102,103,'1',0.01,0.12,0.0,250,250,250" + tap + ",0,0,0,0,1\n0\n0\n";
  else
    t +=
        "0\n102,103,0,'1',1,1,1,0,0,2,'',1,1,1.0\n0.01,0.12,100\n0.98,0,5.0,250,250,250,0,0,1.1,0.9\n1.0,0\n0\n";
  for (const char* section :
       {"area", "dc", "vsc", "switched", "table", "mtdc", "multi", "zone", "transfer", "owner", "facts"}) {
    const std::string name = section;
    if ((version < 29 && name == "vsc") || (version == 24 && name == "owner") ||
        ((version == 24 || version == 25) && name == "facts"))
      continue;
    if (name == "switched")
      t += tap_in_branch   ? "103,1,1.1,0.9,0,5.0,1,5.0\n"
           : version == 30 ? "103,1,1.1,0.9,0,100,'',5.0,1,5.0\n"
                           : "103,1,1.1,0.9,0,'',5.0,1,5.0\n";
    t += "0 / END\n";
  }
  return t;
}

class OldVersion : public ::testing::TestWithParam<int> {};
TEST_P(OldVersion, IsReadAsTheSameGrid) {
  RawCase now;
  now.shunts = "103,'1',1,1.0,20.0\n";
  now.branches = "101,103,'1',0.01,0.12,0.0,250,250,250,0,0,0,0,1,1,0,1,1\n";
  now.transformers = "102,103,0,'1',1,1,1,0,0,2,'',1,1,1.0\n0.01,0.12,100\n0.98,0,5.0\n1.0,0\n";
  now.other["switched shunt"] = "103,1,0,1,1.1,0.9,0,100,'',5.0,1,5.0\n";
  const network::Network a = now.read(), b = parse_raw(old(GetParam()), "old.raw", {60.0, GetParam()});
  ASSERT_EQ(b.buses.size(), 3u);
  ASSERT_EQ(b.loads.size(), 1u);
  EXPECT_EQ(b.buses[2].name, "SOUTH");
  EXPECT_EQ(b.buses[2].kv, 138.0);
  const auto va = network::solve_power_flow(a), vb = network::solve_power_flow(b);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(std::abs(va.voltage[i] - vb.voltage[i]), 0.0, 1e-12) << i;
}
INSTANTIATE_TEST_SUITE_P(Versions, OldVersion, ::testing::Values(23, 24, 25, 26, 27, 28, 29, 30));

TEST(FoundFiles, AsksForMissingHeaderValuesByOption) {
  RawCase c;
  std::string text = c.text();
  text.replace(0, text.find('\n'), "0, 100.0 / RAWD VER 33 EXPORT");
  const std::string all = sentences_of([&] { parse_raw(text, "case.raw"); });
  EXPECT_THAT(all, HasSubstr("REV is missing at case.raw:1"));
  EXPECT_THAT(all, HasSubstr("VER 33"));
  EXPECT_THAT(all, HasSubstr("--raw-version"));
  EXPECT_THAT(all, HasSubstr("--frequency-hz"));
  const network::Network n = parse_raw(text, "case.raw", {50.0, 33});
  EXPECT_EQ(n.frequency, 50.0);
  EXPECT_EQ(places(n, "--raw-version").size(), 1u);
  EXPECT_EQ(places(n, "--frequency-hz").size(), 1u);
}

TEST(FoundFiles, ByteOrderMarkIsSkippedWithARemark) {
  const network::Network n = parse_raw("\xEF\xBB\xBF" + RawCase{}.text(), "case.raw");
  EXPECT_EQ(n.buses.size(), 3u);
  EXPECT_EQ(places(n, "byte-order mark").size(), 1u);
}

TEST(FoundFiles, ReadsASectionThatIsRepeated) {
  std::string text = RawCase{}.text();
  // The section of transformers is the sixth; the section of areas behind it begins twice.
  std::size_t at = 0;
  for (int i = 0; i < 6; ++i) at = text.find("0 / END OF DATA\n", at) + 16;
  text.insert(at, "1,0,0,10,'A'\n0 / END OF TRANSFORMER DATA, BEGIN AREA DATA\n");
  const network::Network n = parse_raw(text, "case.raw");
  EXPECT_EQ(places(n, "second time").size(), 1u);
  EXPECT_EQ(n.branches.size(), 2u);
}

TEST(FoundFiles, BranchesWithoutImpedanceGetTheLeastImpedance) {
  RawCase c;
  c.buses += "104,'WEST',138.0,1,1,1,1,0.99,-8.7\n105,'EAST 2',138.0,1,1,1,1,0.99,-8.7\n";
  c.branches += "103,104,'Z',0.0,0.0\n";
  c.transformers = "104,105,0,'1',1,1,1\n0,0,100\n1.0\n1.0\n";
  const network::Network n = c.read();
  EXPECT_THAT(places(n, "zero-impedance branches"), ::testing::SizeIs(2));
  const network::PowerFlow flow = network::solve_power_flow(n);
  EXPECT_NEAR(std::abs(flow.voltage[2] - flow.voltage[4]), 0.0, 1e-9);
}

TEST(FoundFiles, CorrectionTablesApplyAtThePresentTap) {
  const auto with = [](const std::string& winding, const std::string& table) {
    RawCase c;
    c.transformers = "101,102,0,'T',1,1,1\n0.02,0.1,100\n" + winding + ",0,0,0,0,0,0,0,0,0,0,3\n1.0\n";
    c.other["impedance correction"] = table;
    EXPECT_EQ(parse_raw_survey(c.text(), "case.raw").network.branches[2].x, c.read().branches[2].x);
    return c.read();
  };
  const std::string ratios = "3,0.9,1.2,1.0,1.0,1.1,1.3\n", angles = "3,-30.0,1.4,0.0,1.0,30.0,1.4\n";
  EXPECT_NEAR(with("1.05,0,0", ratios).branches[2].x, 0.115, 1e-12);
  EXPECT_NEAR(with("0.85,0,0", ratios).branches[2].x, 0.12, 1e-12);  // the table is clamped at its end
  EXPECT_NEAR(with("1.05,0,15.0", angles).branches[2].r, 0.024, 1e-12);
  EXPECT_THAT(places(with("1.05,0,0", ratios), "corrected"),
              ::testing::ElementsAre(HasSubstr("101-102 circuit T by 1.15")));
}

TEST(FoundFiles, CorrectionTableOfVersion34SpansLines) {
  std::string t =
      "0,100,34,0,0,60\n1\n2\n0\n1,'A',100,3,1,1,1,1.0,0\n2,'B',100,1,1,1,1,1.0,0\n0\n0\n0\n1,'1',0,0,9,-9,1.0\n0\n0\n0\n"
      "1,2,0,'1',1,1,1\n0.02,0.1,100\n1.15" +
      std::string(22, ',') +
      "3\n1.0\n0\n0\n0\n0\n"
      "3,0.5,1,0,0.6,1,0,0.7,1,0,0.8,1,0,0.9,1,0,1.0,1,0\n1.1,1.2,0.1,1.2,1.4,0.3,0,0,0\n4,1.0,7,0,0,0,0\n0\n";
  for (int i = 0; i < 10; ++i) t += "0\n";
  const network::Network n = parse_raw(t + "Q\n", "case.raw");
  const Complex z = Complex(0.02, 0.1) * Complex(1.3, 0.2);
  EXPECT_NEAR(n.branches[0].r, z.real(), 1e-12);
  EXPECT_NEAR(n.branches[0].x, z.imag(), 1e-12);
}

TEST(FoundFiles, IslandsGetASlackBusOrAreSwitchedOff) {
  RawCase c;
  c.buses +=
      "104,'A',138.0,2,1,1,1,1.0,20.0\n105,'B',138.0,1,1,1,1,1.0,0\n106,'C',138.0,1\n107,'D',138.0,1\n";
  c.generators += "104,'1',10,0,50,-50,1.0,0,100,0,0.3\n";
  c.branches += "104,105,'1',0.01,0.1\n106,107,'1',0.01,0.1\n";
  c.loads += "105,'1',1,1,1,10.0,2.0\n107,'1',1,1,1,5.0,2.0\n";
  const network::Network n = c.read();
  EXPECT_EQ(n.buses[3].type, network::BusType::slack);
  EXPECT_EQ(n.buses[5].type, network::BusType::isolated);
  EXPECT_EQ(n.loads.size(), 2u);
  EXPECT_THAT(places(n, "islands without a slack bus"), ::testing::SizeIs(1));
  EXPECT_THAT(places(n, "islands without a generator"), ::testing::ElementsAre("buses 106, 107"));
  EXPECT_NEAR(std::arg(network::solve_power_flow(n).voltage[3]), 20.0 * std::numbers::pi / 180.0, 1e-12);
}

TEST(FoundFiles, GeneratorAtALoadBusDelivers_WhenTheVoltagesShowIt) {
  RawCase c;
  c.generators += "103,'9',100,20,1,-1,1.0,102,100,0,0.3\n";
  const network::Network off = c.read();  // the voltages of RawCase agree with a load of 250 MW only
  EXPECT_FALSE(off.generators[2].in_service);
  EXPECT_EQ(off.generators[2].regulated, -1);
  EXPECT_THAT(places(off, "out of service, as in PSS/E"), ::testing::SizeIs(1));
  c.loads = "103,'1',1,1,1,350.0,50.0\n";
  const network::Network on = c.read();
  EXPECT_TRUE(on.generators[2].in_service);
  EXPECT_EQ(on.generators[2].regulated, -1);
  const network::PowerFlow flow = network::solve_power_flow(on);
  EXPECT_NEAR(flow.generation[2].real(), 1.0, 1e-12);
  EXPECT_NEAR(flow.generation[2].imag(), 0.2, 1e-12);
}

TEST(FoundFiles, GeneratorsOfOneBusShareAVoltageSetpoint) {
  RawCase c;
  c.generators += "102,'2',1,0,1,-1,1.03,0,100,0,0.3\n";
  const network::Network n = c.read();
  EXPECT_EQ(n.generators[2].vset, 1.02);
  EXPECT_THAT(places(n, "with different set-points"),
              ::testing::ElementsAre(HasSubstr("1.03 pu becomes 1.02 pu")));
}

TEST(FoundFiles, RemoteRegulationIsRead) {
  RawCase c;
  c.generators =
      "101,'1',153.0,73.0,100,-100,1.05,0,100,0,0.3,0,0,1,1,100\n"
      "102,'1',100.0,-3.0,300,-300,1.0,103,100,0,0.25,0,0,1,1,60\n";
  const network::Network n = c.read();
  EXPECT_EQ(n.generators[1].regulated, 2);
  EXPECT_EQ(n.generators[1].share, 60.0);
  EXPECT_NEAR(std::abs(network::solve_power_flow(n).voltage[2]), 1.0, 1e-12);
  c.generators.replace(c.generators.find("103,100"), 3, "199");
  const network::Network own = c.read();
  EXPECT_EQ(own.generators[1].regulated, -1);
  EXPECT_EQ(own.generators[1].vset, 1.02);  // the file's voltage
  EXPECT_THAT(places(own, "a missing bus"), ::testing::SizeIs(1));
  c.generators.replace(c.generators.find("199"), 3, "105");
  c.buses += "105,'B',138.0,1,1,1,1,1.0,0\n";  // isolated, hence out of service
  const network::Network alone = c.read();
  EXPECT_EQ(alone.generators[1].regulated, -1);
  EXPECT_THAT(places(alone, "regulated bus is out of service"), ::testing::SizeIs(1));
}

TEST(FoundFiles, ReplacesImpossibleValuesWithARemark) {
  RawCase c;
  c.buses.replace(c.buses.find("0.99,-8.7"), 4, "0.00");
  c.generators =
      "101,'1',153.0,73.0,100,-100,1.05,0,0,0,0.3,0,0,1,1,100\n"
      "102,'1',100.0,-3.0,300,-300,0.0,103,100,0,0.25,0,0.1,1.05,1,60\n";
  const network::Network n = c.read();
  EXPECT_EQ(n.buses[2].vm, 1.0);
  EXPECT_EQ(n.generators[0].mva, 100.0);
  EXPECT_EQ(n.generators[1].vset, 1.02);
  EXPECT_EQ(n.generators[1].regulated, -1);  // its own bus, not 103
  for (const char* what :
       {"replaced by 1 pu", "replaced by SBASE", "regulate to the file's voltage", "nominal ratio"})
    EXPECT_THAT(places(n, what), ::testing::SizeIs(1)) << what;
}

TEST(FoundFiles, AcceptsIntegersWithPointAndNamesWithApostrophe) {
  RawCase c;
  c.buses.replace(0, 12, "101.0,'O'BRIEN / 1',");
  c.buses.erase(c.buses.find(" / 1',") + 6, 1);
  const network::Network n = c.read();
  EXPECT_EQ(n.buses[0].number, 101);
  EXPECT_EQ(n.buses[0].name, "O'BRIEN / 1");
  c.buses.replace(0, 5, "101.5");
  EXPECT_THAT(sentences_of([&] { c.read(); }), HasSubstr("'101.5'"));
}

TEST(FoundFiles, OmitsOrInfersDevicesOnRequest) {
  RawCase c;
  c.other["FACTS device"] = "'F',102,0,1,0,0,1.0\n";
  c.loads += "103,'2',1,1,1,90.0,0\n";
  EXPECT_THAT(sentences_of([&] { c.read(); }), HasSubstr("--devices file"));
  RawOptions options;
  options.devices = network::DeviceReplacement::file;
  EXPECT_EQ(parse_raw(c.text(), "case.raw", options).loads.back().kind, network::LoadKind::device);
  options.devices = network::DeviceReplacement::none;
  const network::Network n = parse_raw(c.text(), "case.raw", options);
  EXPECT_EQ(n.loads.size(), 2u);
  EXPECT_THAT(places(n, "ignored (--devices none)"), ::testing::SizeIs(1));
}

TEST(FoundFiles, DropsRepeatedRecordsOnRequest) {
  RawCase c;
  c.buses += "103,'SOUTH',138.0,1,1,1,1,0.5,-8.7\n";
  c.loads += "103,'1',1,1,1,10.0,3.0\n";
  c.shunts = "103,'1',1,0.0,10.0\n103,'1',1,0.0,20.0\n";
  c.generators += "102,'1',1.0,0,1,-1,1.03,0,100,0,0.9\n";
  c.branches += "103,101,'1',0.05,0.5,0.0\n";
  c.transformers = "101,102,0,'T',1,1,1\n0,0.1,100\n1.0\n1.0\n102,101,0,'T',1,1,1\n0,0.7,100\n1.0\n1.0\n";
  for (const char* three : {"0.1", "0.9"})
    c.transformers +=
        std::string("101,102,103,'1',1,1,1\n0,") + three + ",100,0,0.1,100,0,0.1,100,1.0,0\n1.0\n1.0\n1.0\n";
  c.other["switched shunt"] = "103,1,0,1,1.5,0.5,0,100,' ',30.0\n103,1,0,1,1.5,0.5,0,100,' ',60.0\n";
  EXPECT_THAT(sentences_of([&] { c.read(); }),
              AllOf(HasSubstr("--repeated voltages"), HasSubstr("--drop-refused leaves it out")));
  RawOptions options;
  options.drop_refused = true;
  const network::Network n = parse_raw(c.text(), "case.raw", options);
  EXPECT_THAT(places(n, "second time is ignored"), ::testing::SizeIs(8));
  EXPECT_EQ(n.buses.size(), 4u);  // with the star point
  EXPECT_EQ(n.buses[2].vm, 0.99);
  ASSERT_EQ(n.loads.size(), 1u);
  EXPECT_EQ(n.loads[0].power.real(), 2.5);
  ASSERT_EQ(n.shunts.size(), 2u);
  EXPECT_NEAR(n.shunts[0].admittance.imag() + n.shunts[1].admittance.imag(), 0.4, 1e-12);
  ASSERT_EQ(n.generators.size(), 2u);
  EXPECT_EQ(n.generators[1].zx, 0.25);
  ASSERT_EQ(n.branches.size(), 6u);
  EXPECT_EQ(n.branches[0].x, 0.12);
  EXPECT_EQ(n.branches[2].x, 0.1);
}

TEST(FoundFiles, PhaseShiftToAnUnloadedBusConverges) {
  RawCase c;
  c.buses += "104,'T',13.8,1\n";
  c.transformers =
      "101,103,104,'1',1,1,1,0.001,-0.01,2,'T',1\n0.005,0.1,100,0.005,0.1,100,0.005,0.1,100,1.0,0\n"
      "1.02\n1.02\n1.0,13.8,30\n";
  const network::PowerFlow flow = network::solve_power_flow(c.read());
  EXPECT_GT(std::abs(flow.voltage[3]), 0.9);
  EXPECT_NEAR(std::arg(flow.voltage[3]) - std::arg(flow.voltage[4]), std::numbers::pi / 6, 1e-9);
}

const char* const kRawx = R"({"network": {
 "caseid": {"fields": ["ic", "sbase", "rev", "xfrrat", "nxfrat", "basfrq", "title1"], "data": [0, 100.0, 35, 0, 0, 60.0, "T"]},
 "bus": {"fields": ["ibus", "name", "baskv", "ide", "vm", "va"],
   "data": [[101, "NORTH", 138.0, 3, 1.05, 0.0], [102, "EAST", 138.0, 2, 1.02, -0.9], [103, "SOUTH", 138.0, 1, 0.99, -8.7]]},
 "load": {"fields": ["ibus", "loadid", "stat", "pl", "ql"], "data": [[103, "1 ", 1, 250.0, 30.0]]},
 "fixshunt": {"fields": ["ibus", "shntid", "stat", "gl", "bl"], "data": [[103, "1", 1, 1.0, 20.0]]},
 "generator": {"fields": ["ibus", "machid", "pg", "qg", "qt", "qb", "vs", "ireg", "mbase", "zr", "zx", "stat"],
   "data": [[101, "1", 153.0, 73.0, 100, -100, 1.05, 0, 100, 0, 0.3, 1], [102, "1", 100.0, null, 100, -100, 1.02, 0, 100, 0, 0.25, 1]]},
 "acline": {"fields": ["ibus", "jbus", "ckt", "rpu", "xpu", "bpu", "stat"], "data": [[101, 103, "1", 0.01, 0.12, 0.0, 1]]},
 "transformer": {"fields": ["ibus", "jbus", "kbus", "ckt", "stat", "r1_2", "x1_2", "sbase1_2", "windv1", "ang1", "windv2"],
   "data": [[102, 103, 0, "1", 1, 0.01, 0.12, 100.0, 0.98, 5.0, 1.0]]},
 "swshunt": {"fields": ["ibus", "shntid", "modsw", "stat", "binit"], "data": [[103, "1", 1, 1, 5.0]]}
}})";

TEST(FoundFiles, ARawxIsReadAsTheSameGrid) {
  const network::Network a = parse_raw(old(30), "old.raw", {60.0, 30}), b = parse_raw(kRawx, "case.rawx");
  const auto va = network::solve_power_flow(a), vb = network::solve_power_flow(b);
  ASSERT_EQ(vb.voltage.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(std::abs(va.voltage[i] - vb.voltage[i]), 0.0, 1e-12) << i;
  EXPECT_EQ(b.loads[0].id, "1");
  EXPECT_EQ(b.generators[1].q, 0.0);
}
/// The case with a substation, whose switch has this status and whose second node is of this bus.
std::string with_substation(int closed, int bus) {
  std::string text = kRawx;
  text.insert(text.rfind("}}"), R"(, "sub": {"fields": ["isub", "name"], "data": [[1, "S"]]},
 "subnode": {"fields": ["isub", "inode", "name", "ibus", "stat"], "data": [[1, 1, "a", 103, 1], [1, 2, "b", )" +
                                    std::to_string(bus) + R"(, 1]]},
 "subswd": {"fields": ["isub", "inode", "jnode", "swdid", "type", "stat"], "data": [[1, 1, 2, "1", 2, )" +
                                    std::to_string(closed) + R"(]]},
 "subterm": {"fields": ["isub", "inode", "type", "eqid", "ibus"], "data": [[1, 1, "L", "1", 103], [1, 2, "B", "1", )" +
                                    std::to_string(bus) + "]]}");
  return text;
}
TEST(FoundFiles, SubstationsOfARawxAreCheckedAsThoseOfARaw) {
  EXPECT_EQ(parse_raw(with_substation(1, 103), "case.rawx").buses.size(), 3u);
  EXPECT_THAT(sentences_of([&] { parse_raw(with_substation(0, 103), "case.rawx"); }),
              HasSubstr("open switches split bus 103 at case.rawx, subterm 2"));
  EXPECT_THAT(sentences_of([&] { parse_raw(with_substation(1, 102), "case.rawx"); }),
              HasSubstr("closed switches join buses 103 and 102 at case.rawx, subterm 2"));
}
TEST(FoundFiles, NamesTableAndRowOfRawxErrors) {
  std::string text = kRawx;
  text.replace(text.find("102, \"1\", 100.0"), 3, "109");
  EXPECT_THAT(sentences_of([&] { parse_raw(text, "case.rawx"); }),
              HasSubstr("bus 109 is not in the bus section at case.rawx, generator 2"));
  for (std::size_t k = 0; k < text.size(); k += 97)
    EXPECT_FALSE(problems_of([&] { parse_raw(text.substr(0, k), "case.rawx"); }).empty()) << k;
}

}  // namespace
}  // namespace swingbank::sim::formats
