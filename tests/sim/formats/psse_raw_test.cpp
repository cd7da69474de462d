#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "sim/network/powerflow.hpp"
#include "tests/sim/formats/raw_case.hpp"
#include "tests/sim/formats/write_raw.hpp"
#include "tests/sim/network/branch_index.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::HasSubstr;
constexpr double kRadian = M_PI / 180.0;

TEST(PsseRaw, ReadsBusesLoadsShuntsGeneratorsAndLines) {
  RawCase c;
  c.loads = "103,'A',1,1,1,250.0,30.0,10.0,20.0,40.0,-50.0,1,1,0\n";
  c.shunts = "102,'1',1,3.0,-7.0\n";
  c.branches += "101,-102,'2',0.02,0.2,0.04,1,1,1,0.001,0.002,0.003,0.004,0,1,0,1,1\n";
  const network::Network n = c.read();
  EXPECT_EQ(n.base_mva, 100.0);
  EXPECT_EQ(n.frequency, 60.0);
  EXPECT_EQ(n.title, "first title\nsecond title");
  ASSERT_EQ(n.buses.size(), 3u);
  EXPECT_EQ(n.buses[1].name, "EAST");
  EXPECT_EQ(n.buses[1].type, network::BusType::generator);
  EXPECT_DOUBLE_EQ(n.buses[2].va, -8.7 * kRadian);
  ASSERT_EQ(n.loads.size(), 1u);
  EXPECT_EQ(n.loads[0].id, "A");
  EXPECT_EQ(n.loads[0].power, Complex(2.5, 0.3));
  EXPECT_EQ(n.loads[0].current, Complex(0.1, 0.2));
  EXPECT_EQ(n.loads[0].admittance, Complex(0.4, 0.5));  // YQ < 0 is inductive: it consumes
  ASSERT_EQ(n.shunts.size(), 1u);
  EXPECT_EQ(n.shunts[0].admittance, Complex(0.03, -0.07));
  ASSERT_EQ(n.generators.size(), 2u);
  EXPECT_EQ(n.generators[1].p, 1.0);
  EXPECT_EQ(n.generators[1].zx, 0.25);
  EXPECT_EQ(n.generators[1].q_min, -1.0);
  ASSERT_EQ(n.branches.size(), 3u);
  const network::Branch& b = n.branches[2];
  EXPECT_EQ(b.to, 1);  // the minus sign only marks the metered end
  EXPECT_EQ(b.b, 0.04);
  EXPECT_EQ(b.shunt_from, Complex(0.001, 0.002));
  EXPECT_EQ(b.shunt_to, Complex(0.003, 0.004));
  EXPECT_FALSE(b.in_service);
  EXPECT_EQ(network::branch_index(n, 102, 101, "2"), 2);
  EXPECT_EQ(network::branch_index(n, 102, 101, "1"), -1);
  EXPECT_EQ(n.bus_index(103), 2);
  EXPECT_EQ(n.bus_index(7), -1);
}

TEST(PsseRaw, NamesMayHoldCommasSlashesAndQuotes) {
  RawCase c;
  c.buses =
      "101,'NORTH, UPPER / A', 138.0,3,1,1,1,1.05,0.0 / comment, with 'quote\n102 \"O'BRIEN\" 138.0 2 1 1 1 "
      "1.02 -0.9\n\n103,'IT''S',138.0,1,1,1,1,0.99,-8.7\n";
  const network::Network n = c.read();
  ASSERT_EQ(n.buses.size(), 3u);
  EXPECT_EQ(n.buses[0].name, "NORTH, UPPER / A");
  EXPECT_EQ(n.buses[1].name, "O'BRIEN");  // blanks separate fields as well as commas do
  EXPECT_EQ(n.buses[1].vm, 1.02);
  EXPECT_EQ(n.buses[2].name, "IT'S");
}

TEST(PsseRaw, Versions32And33GiveTheSameNetwork) {
  RawCase c33, c32;
  c32.version = 32;
  c32.buses =
      "101,'NORTH', 138.0,3,1,1,1,1.05,0.0\n102,'EAST',138.0,2,1,1,1,1.02,-0.9\n"
      "103,'SOUTH',138.0,1,1,1,1,0.99,-8.7\n";
  c32.loads = "103,'1',1,1,1,250.0,30.0,0,0,0,0,1,1\n";
  const network::Network a = c33.read(), b = c32.read();
  ASSERT_EQ(a.buses.size(), b.buses.size());
  for (std::size_t i = 0; i < a.buses.size(); ++i) EXPECT_EQ(a.buses[i].vm, b.buses[i].vm);
  EXPECT_EQ(a.loads[0].power, b.loads[0].power);
  EXPECT_EQ(a.branches.size(), b.branches.size());
}

TEST(PsseRaw, OtherVersionsAreRefusedByName) {
  for (const int version : {1, 22, 36}) {
    RawCase c;
    c.version = version;
    const auto text = sentences_of([&] { c.read(); });
    EXPECT_THAT(text, HasSubstr("version " + std::to_string(version)));
    EXPECT_THAT(text, HasSubstr("case.raw:1"));
  }
}

TEST(PsseRaw, OmittedFieldsTakeTheDocumentedDefaults) {
  RawCase c;
  c.header_rest = ",,,60";
  c.buses = "101,,,3\n102,'EAST',138,2/\n103\n";
  c.loads = "103,,,,,250\n";
  c.generators = "101\n102,'1',100\n";
  c.branches = "101,103,,,0.12\n102,103,,,0.12\n";
  const network::Network n = c.read();
  EXPECT_EQ(n.buses[2].type, network::BusType::load);
  EXPECT_EQ(n.buses[2].vm, 1.0);
  EXPECT_EQ(n.buses[2].va, 0.0);
  EXPECT_EQ(n.loads[0].id, "1");
  EXPECT_EQ(n.loads[0].power, Complex(2.5, 0.0));
  const network::Generator& g = n.generators[0];
  EXPECT_EQ(g.id, "1");
  EXPECT_EQ(g.p, 0.0);
  EXPECT_EQ(g.vset, 1.0);
  EXPECT_EQ(g.mva, 100.0);
  EXPECT_EQ(g.zr, 0.0);
  EXPECT_EQ(g.zx, 1.0);
  EXPECT_TRUE(g.in_service);
  EXPECT_EQ(n.branches[0].circuit, "1");
  EXPECT_EQ(n.branches[0].r, 0.0);
  EXPECT_TRUE(n.branches[0].in_service);
}

TEST(PsseRaw, OmitsOrMarksEquipmentOutOfService) {
  RawCase c;
  c.buses += "104,'GONE',138.0,4,1,1,1,1.0,0.0\n";
  c.loads += "103,'2',0,1,1,1,1,0,0,0,0,1\n104,'1',1,1,1,1,1,0,0,0,0,1\n";
  c.shunts = "103,'1',0,3.0,-7.0\n104,'1',1,0,5\n";
  c.generators += "104,'1',1.0,0,1,-1,1.0,0,100,0,0.3,0,0,1,1\n102,'2',9.0,0,1,-1,1.0,0,100,0,0.3,0,0,1,0\n";
  c.branches += "103,104,'1',0.01,0.12,0.0\n";
  const network::Network n = c.read();
  EXPECT_EQ(n.loads.size(), 1u);
  EXPECT_TRUE(n.shunts.empty());
  EXPECT_FALSE(n.generators[2].in_service);  // at the isolated bus
  EXPECT_FALSE(n.generators[3].in_service);
  EXPECT_FALSE(n.branches[2].in_service);
}

TEST(PsseRaw, SwitchedShuntsCountWithTheirInitialSusceptance) {
  RawCase c;
  c.other["switched shunt"] =
      "103,1,0,1,1.1,0.9,0,100,'',-25.0,5,-5\n102,1,0,0,1.1,0.9,0,100,'',40.0,5,8\n"
      "101,1,0,1,1.1,0.9,0,100,'',0.0,5,8\n";
  const network::Network n = c.read();
  ASSERT_EQ(n.shunts.size(), 2u);  // one is out of service, one has no step switched in
  EXPECT_EQ(n.shunts[0].bus, 2);
  EXPECT_EQ(n.shunts[0].admittance, Complex(0.0, -0.25));
  EXPECT_EQ(n.shunts[1].bus, 0);
  EXPECT_EQ(n.shunts[1].admittance, Complex());
  ASSERT_EQ(n.switched.size(), 2u);
  EXPECT_EQ(n.switched[0].present, -0.25);
  EXPECT_EQ(n.switched[0].id, n.shunts[0].id);
  EXPECT_EQ(n.switched[1].present, 0.0);
}

TEST(PsseRaw, StepsOfSwitchedShuntsKeepTheOrderOfReactorsAndCapacitors) {
  RawCase c;
  c.other["switched shunt"] =
      "103,1,0,1,1.03,0.97,101,100,'',20.0,1,-30,2,10,0,99,3,5\n"
      "102,2,0,1,1.1,0.9,0,100,'',40.0,5,8\n";
  const network::Network n = c.read();
  ASSERT_EQ(n.switched.size(), 1u);
  const network::SwitchedShunt& s = n.switched[0];
  EXPECT_EQ(s.bus, 2);
  EXPECT_EQ(s.regulated, 0);
  EXPECT_EQ(s.least, 0.97);
  EXPECT_EQ(s.most, 1.03);
  EXPECT_EQ(s.steps, (std::vector<double>{-0.3, 0.0, 0.1, 0.2, 0.25, 0.3, 0.35}));
  ASSERT_EQ(n.remarks.size(), 1u);  // about the shunt with another control mode
  EXPECT_NE(n.remarks[0].what.find("a control mode other"), std::string::npos);
}

TEST(PsseRaw, RefusesABandWithoutVoltagesAndABlockOfNegativeSteps) {
  RawCase c;
  c.other["switched shunt"] = "103,1,0,1,0.97,1.03,0,100,'',20.0,-1,10\n";
  try {
    (void)c.read();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems().size(), 2u);
  }
}

struct Device {
  const char *section, *record, *bus;
};
class PsseRawDevices : public ::testing::TestWithParam<Device> {};
TEST_P(PsseRawDevices, PowerFollowsFromTheFileVoltages) {
  // The three-bus case solved with a load at bus 103; the device's record then replaces the load.
  RawCase c;
  network::Network solved = c.read();
  const network::PowerFlow flow = network::solve_power_flow(solved);
  for (std::size_t i = 0; i < 3; ++i) {
    solved.buses[i].vm = std::abs(flow.voltage[i]);
    solved.buses[i].va = std::arg(flow.voltage[i]);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    solved.generators[i].p = flow.generation[i].real();
    solved.generators[i].q = flow.generation[i].imag();
  }
  const Complex drawn = solved.loads[0].power;
  solved.loads.clear();
  std::string text = raw_text(solved, 33);
  const std::string end = "0 / end of " + std::string(GetParam().section) + " data\n";
  ASSERT_NE(text.find(end), std::string::npos);
  text.insert(text.find(end), GetParam().record);
  const network::Network n = parse_raw(text, "case.raw");
  Complex sum{};
  for (const network::Load& l : n.loads) {
    EXPECT_EQ(l.kind, network::LoadKind::device);
    sum += l.power;
  }
  EXPECT_NEAR(std::abs(sum - drawn), 0.0, 1e-9);
  ASSERT_FALSE(n.remarks.empty());
  EXPECT_THAT(n.remarks[0].what, HasSubstr("equipment without a model"));
  EXPECT_THAT(n.remarks[0].places.back(), HasSubstr("at bus 103"));
  // If the case is not solved, the device's power is unknown.
  RawCase flat;
  flat.other[GetParam().bus] = GetParam().record;
  flat.loads = "102,'1',1,1,1,10.0,0\n";
  flat.buses += "104,'WEST',138.0,1\n";
  flat.branches += "104,101,'1',0.01,0.12\n";
  EXPECT_THAT(sentences_of([&] { flat.read(); }), HasSubstr("they do not satisfy the power flow"));
}
INSTANTIATE_TEST_SUITE_P(
    Sections, PsseRawDevices,
    ::testing::Values(
        Device{"two-terminal dc", "'DC 1',1,8.2,100.0,500.0\n101,2,8,20\n103,2,8,20\n",
               "two-terminal dc line"},
        Device{"vsc dc line", "'VDC 1',1,0.71\n101,1,1,10\n103,1,1,10\n", "voltage source converter dc line"},
        Device{"multi-terminal dc", "'MDC 1',2,1,1,1\n101,2\n103,2\n1,101\n1,2,'1'\n",
               "multi-terminal dc line"},
        Device{"facts device", "'FACTS 1',103,0,1,0,0,1.0\n", "FACTS device"},
        Device{"gne", "'GNE 1','MODEL',1,103,11,0,1\n1,1,1\n1,2,3,4,5,6,7,8,9,10\n11\n'A'\n", "GNE device"},
        Device{"induction machine", "103,'1',1,1,1,1,1,1,1,5,5\n", "induction machine"}));

TEST(PsseRaw, IgnoresDevicesOutOfService) {
  RawCase c;
  c.other["two-terminal dc line"] = "'DC 1',0,8.2,100.0,500.0\n101,2,8,20\n103,2,8,20\n";
  c.other["FACTS device"] = "'F',103,0,0\n";
  c.other["GNE device"] = "'G','MODEL',1,103,0,0,0\n0,1,1\n";
  EXPECT_EQ(c.read().loads.size(), 1u);
}

TEST(PsseRaw, SkipsSectionsWithoutEffectOnTheEquations) {
  RawCase c;
  c.other["area"] = "1,101,0.0,10.0,'AREA, ONE'\n";
  c.other["impedance correction"] = "1,-30.0,1.1,0.0,1.0,30.0,1.1\n";
  c.other["multi-section line"] = "101,103,'&1',1,102\n";
  c.other["zone"] = "1,'ZONE'\n";
  c.other["inter-area transfer"] = "1,2,'A',5.0\n";
  c.other["owner"] = "1,'OWNER'\n";
  EXPECT_EQ(c.read().branches.size(), 2u);
}

TEST(PsseRaw, ReportsAllErrorsWithTheirLines) {
  RawCase c;
  c.buses +=
      "103,'TWICE',138.0,1\n105,'NAN',138.0,1,1,1,1,nan,0\n106,'TYPE',138.0,7\n107,'V',138,1,1,1,1,0.0\n";
  c.buses += "00,'ZERO',138.0,1\n";
  c.loads += "-103,'8',1,1,1,1.0,1.0\n";
  c.loads += "999,'1',1,1,1,1.0,1.0\n103,'1',1,1,1,1.0,1.0\n103,'3',5,1,1,1.0,1.0\n103,'4',1,1,1,1.0x,1.0\n";
  c.generators +=
      "103,'9',1,0,1,-1,1.0,0,100,0,0.3\n102,'3',1,0,1,-1,1.02,0,-5,0,0.3\n"
      "102,'4',1,0,1,-1,1.03,0,100,0,0.3\n102,'5',1,0,1,-1,1.02,101,100,0,0.3\n"
      "102,'6',1,0,1,-1,1.02,0,100,0,0.3,0,0.1,1.05\n102,'7',1,0,1,-1,1.02,0,100,0,0.3,0,-0.1\n";
  c.branches += "101,102,'1',0.0,0.0\n101,102,'7',0.01\n102,103,'1',0.0,0.1\n101,101,'1',0,0.1\n";
  c.transformers = "101,102,103,'1',1,1,1\n0,0.1,100\n1,0,0\n1,0\n";
  const std::string text = c.text();
  const auto problems = problems_of([&] { c.read(); });
  const auto expect = [&](const std::string& record, const std::string& what) {
    const std::string line = ":" + std::to_string(line_of(text, record));
    for (const Problem& p : problems)
      if (p.where.ends_with(line) && p.sentence().find(what) != std::string::npos) return;
    ADD_FAILURE() << "no problem '" << what << "' on line " << line;
  };
  expect("00,'ZERO'", "bus number 0");
  expect("103,'TWICE'", "bus 103 appears twice");
  expect("105,'NAN'", "VM = 'nan'");
  expect("106,'TYPE'", "IDE = 7");
  expect("-103,'8'", "bus -103 is not in the bus section");
  expect("999,'1'", "bus 999 is not in the bus section");
  expect("103,'1',1,1,1,1.0,1.0", "load '1' at bus 103 appears twice");
  expect("103,'3',5", "STATUS = 5");
  expect("103,'4'", "PL = '1.0x'");
  expect("102,'7'", "XT = -0.1 pu");
  expect("101,102,'7'", "X is missing");
  expect("102,103,'1',0.0,0.1", "appears twice");
  expect("101,101,'1'", "to itself");
  expect("101,102,103,'1'", "with 4 lines");
}

TEST(PsseRaw, ReportsTruncation_WhereverTheFileEnds) {
  std::ifstream in(std::string(SWINGBANK_SOURCE) + "/configs/networks/ieee14_genrou.raw");
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  ASSERT_GT(lines.size(), 60u);
  ASSERT_EQ(lines.back(), "Q");
  std::string text;
  // Programs omit sections at the end. A file that lacks only sections after the transformers is complete and
  // gets a remark.
  std::size_t k = 0;
  for (; lines[k] != "0 / end of transformer data"; ++k) {
    text += lines[k] + "\n";
    const ScratchFile file("cut.raw", text);
    EXPECT_THAT(sentences_of([&] { read_raw(file.path); }), HasSubstr("truncated")) << "after line " << k + 1;
  }
  for (; k + 2 < lines.size(); ++k) {
    text += lines[k] + "\n";
    EXPECT_THAT(parse_raw(text, "cut.raw").remarks.back().what,
                HasSubstr("the file ends before its last sections"));
  }
}

TEST(PsseRaw, FilesThatCannotBeReadAreNamed) {
  EXPECT_THAT(sentences_of([] { read_raw("/nowhere/case.raw"); }), HasSubstr("/nowhere/case.raw"));
  EXPECT_THAT(sentences_of([] { read_raw(std::filesystem::temp_directory_path()); }),
              HasSubstr("cannot read"));
  const ScratchFile empty("empty.raw", "");
  EXPECT_THAT(sentences_of([&] { read_raw(empty.path); }), HasSubstr("it is empty"));
}

}  // namespace
}  // namespace swingbank::sim::formats
