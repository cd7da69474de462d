// Errors of a .raw that are repaired on request or as PSS/E does: equipment that appears twice or at a
// missing bus, dangling references, a missing title line, comments, dc lines that differ from their schedule.
#include <gmock/gmock.h>

#include <cmath>

#include "sim/formats/pslf_epc.hpp"
#include "sim/network/powerflow.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

RawOptions repeated(Repeated how) {
  RawOptions options;
  options.repeated = how;
  return options;
}
RawOptions dropping() {
  RawOptions options;
  options.drop_refused = true;
  return options;
}
network::Network read(const RawCase& c, const RawOptions& options) {
  return parse_raw(c.text(), "case.raw", options);
}

/// Writes the voltages of the power flow of `solved` into the case.
void store_voltages(RawCase& c, const network::Network& solved) {
  const network::PowerFlow flow = network::solve_power_flow(solved);
  c.buses.clear();
  for (std::size_t i = 0; i < solved.buses.size(); ++i) {
    if (solved.buses[i].is_star()) continue;
    char line[120];
    std::snprintf(line, sizeof line, "%d,'B',138.0,%d,1,1,1,%.5f,%.4f\n", solved.buses[i].number,
                  static_cast<int>(solved.buses[i].type), std::abs(flow.voltage[i]),
                  std::arg(flow.voltage[i]) * 57.29577951308232);
    c.buses += line;
  }
}
const char* const kParallel = "103,101,'1',0.01,0.12,0.0\n";

TEST(RepeatedBranch, IsKeptUnderANewId_WhenTheVoltagesShowIt) {
  RawCase both;
  both.branches += kParallel;
  RawCase distinct = both;
  distinct.branches.replace(distinct.branches.find(kParallel) + 8, 3, "'2'");
  const network::Network reference = distinct.read();
  store_voltages(both, reference);
  const network::Network n = read(both, repeated(Repeated::voltages));
  ASSERT_THAT(n.branches, SizeIs(3));
  EXPECT_EQ(n.branches[2].circuit, "R1");
  EXPECT_TRUE(n.branches[2].in_service);
  EXPECT_THAT(places(n, "kept under a new id, because the file's voltages confirm it"),
              ElementsAre(AllOf(HasSubstr("branch 101-103 circuit '1'"), HasSubstr("as 'R1'"))));
  const auto a = network::solve_power_flow(n), b = network::solve_power_flow(reference);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(std::abs(a.voltage[i] - b.voltage[i]), 0.0, 1e-12) << i;
}

TEST(RepeatedBranch, IsOmitted_WhenTheVoltagesShowIt) {
  RawCase c;
  store_voltages(c, RawCase{}.read());
  c.branches += kParallel;
  const network::Network n = read(c, repeated(Repeated::voltages));
  ASSERT_THAT(n.branches, SizeIs(3));
  EXPECT_FALSE(n.branches[2].in_service);
  EXPECT_THAT(places(n, "ignored, because the file's voltages contradict it"), SizeIs(1));
  const auto a = network::solve_power_flow(n), b = network::solve_power_flow(RawCase{}.read());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(std::abs(a.voltage[i] - b.voltage[i]), 0.0, 1e-12) << i;
}

TEST(RepeatedBranch, IsDecidedForEachPairSeparately) {
  RawCase c;
  c.branches += kParallel;
  RawCase distinct = c;
  distinct.branches.replace(distinct.branches.find(kParallel) + 8, 3, "'2'");
  store_voltages(c, distinct.read());
  c.branches += "102,103,'1',0.01,0.12,0.0\n";
  const network::Network n = read(c, repeated(Repeated::voltages));
  EXPECT_TRUE(n.branches[2].in_service);
  EXPECT_FALSE(n.branches[3].in_service);
}

TEST(RepeatedBranch, IsKeptOnRequestWhateverTheVoltages) {
  RawCase c;
  c.branches += kParallel + std::string(kParallel);
  const network::Network n = read(c, repeated(Repeated::kept));
  ASSERT_THAT(n.branches, SizeIs(4));
  EXPECT_EQ(n.branches[2].circuit, "R1");
  EXPECT_EQ(n.branches[3].circuit, "R2");
  EXPECT_THAT(places(n, "kept under a new id (--repeated keep)"), SizeIs(2));
}

TEST(RepeatedEquipment, OfEveryKindIsDecidedByTheVoltages) {
  RawCase once;
  once.shunts = "103,'1',1,0.0,20.0\n";
  once.buses += "104,'T',13.8,1,1,1,1,1.0,0\n";
  once.transformers =
      "101,103,104,'1',1,1,1\n0.005,0.2,100,0.005,0.2,100,0.005,0.2,100,1.0,0\n1.0\n1.0\n1.0\n";
  once.loads += "104,'1',1,1,1,5.0,1.0\n";
  const auto twice = [&](RawCase c) {
    c.shunts += "103,'1',1,0.0,40.0\n";
    c.loads += "103,'1',1,1,1,30.0,10.0\n";
    c.generators += "102,'1',10.0,0,100,-100,1.02,0,100,0,0.25\n";
    c.transformers +=
        "101,103,104,'1',1,1,1\n0.005,0.4,100,0.005,0.4,100,0.005,0.4,100,1.0,0\n1.0\n1.0\n1.0\n";
    return c;
  };
  for (const bool with : {true, false}) {
    RawCase stored = twice(once);
    store_voltages(stored, with ? read(stored, repeated(Repeated::kept)) : once.read());
    const network::Network n = read(stored, repeated(Repeated::voltages));
    EXPECT_THAT(places(n, with ? "kept under a new id, because the file's voltages confirm it"
                               : "ignored, because the file's voltages contradict it"),
                SizeIs(4))
        << with;
    EXPECT_EQ(n.loads.size(), with ? 3u : 2u);
    EXPECT_EQ(n.shunts.size(), with ? 2u : 1u);
  }
}

TEST(RepeatedBus, IsNeverKept) {
  RawCase c;
  c.buses += "103,'SOUTH',138.0,1\n";
  EXPECT_THAT(sentences_of([&] { read(c, repeated(Repeated::kept)); }), HasSubstr("bus 103 appears twice"));
}

TEST(MissingBus, EquipmentIsLeftOutAndNamedOnRequest) {
  RawCase c;
  c.loads += "177,'1',1,1,1,5.0,1.0\n";
  c.shunts = "178,'1',1,0.0,10.0\n";
  c.generators += "179,'1',1,0,9,-9,1.0,0,100,0,0.3\n";
  c.branches += "103,177,'1',0.01,0.1\n";
  c.transformers =
      "101,180,0,'1',1,1,1\n0,0.1,100\n1.0\n1.0\n101,102,181,'1',1,1,1\n0,0.1,100,0,0.1,100,0,0.1,100,1,0\n1\n1\n1\n";
  c.other["switched shunt"] = "182,1,0,1,1.1,0.9,0,100,'',5.0,1,5.0\n";
  c.other["FACTS device"] = "'F',183,0,1,0,0,1.0\n";
  EXPECT_THAT(problems_of([&] { read(c, {}); }), SizeIs(8));
  EXPECT_THAT(sentences_of([&] { read(c, {}); }), HasSubstr("leave the equipment out with --drop-refused"));
  const network::Network n = read(c, dropping());
  EXPECT_THAT(places(n, "not in the bus section is ignored (--drop-refused)"), SizeIs(8));
  EXPECT_THAT(places(n, "not in the bus section")[0], HasSubstr("load record at bus 177 (case.raw:"));
  const network::PowerFlow a = network::solve_power_flow(n), b = network::solve_power_flow(RawCase{}.read());
  ASSERT_EQ(n.buses.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(std::abs(a.voltage[i] - b.voltage[i]), 0.0, 1e-14) << i;
}

TEST(MissingReference, IsReplacedAndNamed) {
  RawCase c;
  c.other["switched shunt"] = "103,1,0,1,1.1,0.9,199,100,'',5.0,1,5.0\n";
  const network::Network n = c.read();
  ASSERT_THAT(n.switched, SizeIs(1));
  EXPECT_EQ(n.switched[0].regulated, 2);
  EXPECT_THAT(places(n, "switched shunts that regulate a missing bus"),
              ElementsAre(HasSubstr("SWREG = 199")));
  c.other["switched shunt"] = "103,1,0,1,0.9,1.1,0,100,'',5.0,1,5.0\n";
  c.transformers = "101,102,0,'T',1,1,1\n0.02,0.1,100\n1.05,0,0,0,0,0,0,0,0,0,0,0,0,3\n1.0\n";
  EXPECT_THAT(sentences_of([&] { c.read(); }), AllOf(HasSubstr("VSWLO above VSWHI"), HasSubstr("TAB1 = 3")));
  const network::Network dropped = read(c, dropping());
  EXPECT_THAT(dropped.switched, IsEmpty());
  EXPECT_EQ(dropped.shunts.back().admittance.imag(), 0.05);
  EXPECT_EQ(dropped.branches[2].x, 0.1);
  EXPECT_THAT(places(dropped, "stay at BINIT (--drop-refused)"), SizeIs(1));
  EXPECT_THAT(places(dropped, "correction tables are ignored (--drop-refused)"),
              ElementsAre(HasSubstr("TAB1 = 3")));
}

TEST(ThreeWindings, StarVoltageAndBaseOfZeroAreReplacedAndNamed) {
  const auto with = [](const std::string& base, const std::string& star, int cz) {
    RawCase c;
    c.buses += "104,'T',13.8,1\n";
    c.transformers = "101,103,104,'1',1," + std::to_string(cz) + ",1\n0.005,0.1," + base + ",0.005,0.1," +
                     base + ",0.005,0.1," + base + "," + star + ",0\n1.0\n1.0\n1.0\n";
    return c;
  };
  const network::Network n = with("0.0", "0.0", 1).read(), whole = with("100.0", "1.0", 1).read();
  EXPECT_THAT(places(n, "star-point voltages of 0 pu or below"), ElementsAre(HasSubstr("VMSTAR = 0 pu")));
  EXPECT_THAT(places(n, "winding bases"), SizeIs(3));
  const auto a = network::solve_power_flow(n), b = network::solve_power_flow(whole);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(std::abs(a.voltage[i] - b.voltage[i]), 0.0, 1e-9) << i;
  EXPECT_THAT(sentences_of([&] { with("0.0", "1.0", 2).read(); }), HasSubstr("SBASE1-2 = 0 MVA"));
}

TEST(TitleLines, AMissingOneIsNamed) {
  for (const int missing : {1, 2}) {
    std::string text = RawCase{}.text();
    text.erase(text.find("first title\n"), missing == 1 ? 12 : 25);
    const auto problems = problems_of([&] { parse_raw(text, "case.raw"); });
    ASSERT_THAT(problems, SizeIs(1));
    EXPECT_EQ(problems[0].what,
              missing == 1 ? "line 3 looks like a bus record" : "line 2 looks like a bus record");
  }
  for (const char* title : {"2026, 'SUMMER PEAK', 12 3 4 5 6 7", "1 2 3 4", "7,'A',1.0,9,1,1,1,1.0,0", ""}) {
    std::string text = RawCase{}.text();
    text.replace(text.find("second title"), 12, title);
    EXPECT_THAT(problems_of([&] { parse_raw(text, "case.raw"); }), IsEmpty()) << title;
  }
}

TEST(Comments, AreIgnoredAtLineEndsAndOnTheirOwnLines) {
  RawCase c;
  c.loads = "# loads of the summer peak\n103,'1',1,1,1,250.0,30.0 ! summer\n";
  c.branches = "! lines\n101,103,'1',0.01,0.12 # 40 km\n102,103,'1',0.01,0.12, # 40 km, old\n// no more\n";
  const network::Network n = c.read();
  ASSERT_THAT(n.branches, SizeIs(2));
  EXPECT_EQ(n.branches[1].b, 0.0);
  EXPECT_EQ(n.loads[0].power, Complex(2.5, 0.3));
  c.loads = "103,#1,1,1,1,250.0,30.0\n";  // an id behind a comma
  EXPECT_EQ(c.read().loads[0].id, "#1");
}

TEST(DcLine, FarFromItsScheduleIsNamed) {
  RawCase c;
  RawOptions file;
  file.devices = network::DeviceReplacement::file;
  const auto line = [](const std::string& mode, const std::string& set) {
    return "'DC1'," + mode + ",8.0," + set + ",200.0\n102,1,20.0\n103,1,20.0\n";
  };
  // RawCase's voltages balance bus 103: the power of the line is almost zero there.
  c.other["two-terminal dc line"] = line("1", "100.0");
  const network::Network n = read(c, file);
  EXPECT_THAT(
      places(n, "far from its schedule"),
      ::testing::Contains(AllOf(HasSubstr("dc line 'DC1' at bus 103"), HasSubstr("-98.00 MW scheduled"))));
  // 500 A at 200 kV are the same 100 MW; a negative value is the inverter's power.
  c.other["two-terminal dc line"] = line("2", "500.0");
  EXPECT_THAT(places(read(c, file), "far from its schedule"),
              ::testing::Contains(HasSubstr("-98.00 MW scheduled")));
  c.other["two-terminal dc line"] = line("1", "-100.0");
  EXPECT_THAT(places(read(c, file), "far from its schedule"),
              ::testing::Contains(HasSubstr("-100.00 MW scheduled")));
  c.other["two-terminal dc line"] = line("1", "0.0");
  for (const std::string& place : places(read(c, file), "far from its schedule"))
    EXPECT_THAT(place, ::testing::Not(HasSubstr("at bus 103")));
}

}  // namespace
}  // namespace swingbank::sim::formats
