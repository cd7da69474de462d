#include "sim/formats/matpower.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "sim/network/powerflow.hpp"
#include "tests/sim/formats/flatten.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::HasSubstr;

const std::string kCase =
    "function mpc = four\n"
    "%FOUR  a case of our own; semicolons; [brackets] and 'quotes in a comment\n"
    "mpc.version = '2';\n"
    "%{\nmpc.baseMVA = 1;\n%}\n"
    "mpc.baseMVA = 200; mpc.note = 'it''s 100 % synthetic';\n"
    "mpc.bus = [ % bus_i type Pd Qd Gs Bs area Vm Va baseKV zone Vmax Vmin\n"
    "\t1\t3\t0\t0\t0\t0\t1\t1.02\t0\t110\t1\t1.1\t0.9;\n"
    "\t2, 2, 30, 10, 0, 0, 1, 1.01, -1.5, 110, 1, 1.1, 0.9\n"
    "\t3 1 120 40 2 -30 ...  a long row\n\t\t1 0.99 -4 110 1 1.1 0.9; 4 1 0 0 0 0 1 1 0 20 1 1.1 0.9;\n"
    "];\n"
    "mpc.gen = [\n"
    "1 80 20 Inf -Inf 1.02 150 1 200 0;\n"
    "2 60 5 40 -30 1.01 120 1 150 0;\n"
    "2 40 5 40 -30 1.01 60 0 150 0;\n"
    "];\n"
    "mpc.branch = [\n"
    "1 3 0.01 0.08 0.03 250 250 250 0 0 1 -360 360;\n"
    "3 1 0.01 0.08 0.03 250 250 250 0 0 0 -360 360;\n"
    "2 3 0.01 1e-1 0.02 250 250 250 0 0 1 -360 360;\n"
    "3 4 0 0.12 0 0 0 0 0.975 30 1 -360 360;\n"
    "];\n"
    "mpc.gencost = [2 0 0 3 0.01 0.3 0.2; 2 0 0 3 0.01 0.3 0.2];\n"
    "mpc.bus_name = {\n 'one; [two'; \"three\"\n};\n";

TEST(Matpower, ReadsBusesLoadsShuntsGeneratorsAndBranches) {
  const network::Network n = parse_matpower(kCase, "four.m", 50.0);
  EXPECT_EQ(n.base_mva, 200.0);
  EXPECT_EQ(n.frequency, 50.0);
  ASSERT_EQ(n.buses.size(), 4u);
  EXPECT_EQ(n.buses[0].type, network::BusType::slack);
  EXPECT_EQ(n.buses[1].type, network::BusType::generator);
  EXPECT_EQ(n.buses[2].vm, 0.99);
  EXPECT_DOUBLE_EQ(n.buses[2].va, -4.0 * std::numbers::pi / 180.0);
  ASSERT_EQ(n.loads.size(), 2u);
  EXPECT_EQ(n.loads[1].power, Complex(0.6, 0.2));
  ASSERT_EQ(n.shunts.size(), 1u);
  EXPECT_EQ(n.shunts[0].admittance, Complex(0.01, -0.15));
  ASSERT_EQ(n.generators.size(), 3u);
  EXPECT_EQ(n.generators[1].mva, 120.0);
  EXPECT_EQ(n.generators[1].q_min, -0.15);
  EXPECT_EQ(n.generators[2].id, "2");
  EXPECT_FALSE(n.generators[2].in_service);
  ASSERT_EQ(n.branches.size(), 4u);
  EXPECT_EQ(n.branches[1].circuit, "2");
  EXPECT_FALSE(n.branches[1].in_service);
  EXPECT_EQ(n.branches[0].tap, 1.0);
  EXPECT_FALSE(n.branches[0].transformer);
  EXPECT_EQ(n.branches[3].tap, 0.975);
  EXPECT_TRUE(n.branches[3].transformer);
  EXPECT_DOUBLE_EQ(n.branches[3].shift, std::numbers::pi / 6);
}

TEST(Matpower, TheSameCaseAsARawGivesTheSamePowerFlow) {
  RawCase c;
  c.buses = "1,'',110,3,1,1,1,1.02,0\n2,'',110,2,1,1,1,1.01,-1.5\n3,'',110,1,1,1,1,0.99,-4\n4,'',20,1\n";
  c.loads = "2,'1',1,1,1,30,10\n3,'1',1,1,1,120,40\n";
  c.shunts = "3,'1',1,2,-30\n";
  c.generators = "1,'1',80,20,100,-100,1.02,0,150\n2,'1',60,5,40,-30,1.01,0,120\n";
  c.branches = "1,3,'1',0.01,0.08,0.03\n2,3,'1',0.01,0.1,0.02\n";
  c.transformers = "3,4,0,'1'\n0,0.12\n0.975,0,30\n1\n";
  std::string raw = c.text();
  raw.replace(raw.find("100.0"), 5, "200.0");
  const network::PowerFlow a = network::solve_power_flow(parse_raw(raw, "four.raw")),
                           b = network::solve_power_flow(parse_matpower(kCase, "four.m", 60.0));
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT(std::abs(a.voltage[i] - b.voltage[i]), 1e-13) << i;  // rounding
}

TEST(Matpower, ReportsAllErrorsWithTheirLines) {
  const std::string text =
      "function mpc = bad\n"
      "mpc.version = '2';\n"
      "mpc.baseMVA = 0;\n"
      "mpc.bus = [\n"
      "1 3 0 0 0 0 1 1 0 110 1 1.1 0.9;\n"
      "1 2 0 0 0 0 1 1 0 110 1 1.1 0.9;\n"
      "2 9 0 0 0 0 1 1 0 110 1 1.1 0.9;\n"
      "3 1 NaN 0 0 0 1 1 0 110 1 1.1 0.9;\n"
      "4 1 0 0 0 0 1 0 0 110 1 1.1 0.9;\n"
      "5 1 0 0;\n"
      "6 1 1/3 0 0 0 1 1 0 110 1 1.1 0.9;\n"
      "7.5 1 0 0 0 0 1 1 0 110 1 1.1 0.9;\n"
      "];\n"
      "mpc.gen = [\n"
      "9 0 0 1 -1 1 100 1 1 0;\n"
      "1 0 0 1 -1 0 0 1 1 0;\n"
      "3 0 0 1 -1 1 100 1 1 0;\n"
      "];\n"
      "mpc.branch = [\n"
      "1 1 0 0.1 0 0 0 0 0 0 1;\n"
      "1 2 0 0 0 0 0 0 0 0 1;\n"
      "1 2 0 0.1 0 0 0 0 -1 0 1;\n"
      "];\n"
      "mpc.branch(:, 3) = mpc.branch(:, 3) / 10;\n"
      "mpc.dcline = [1 2 1 10];\n"
      "mpc.gen = [1];\n"
      "x = 3;\n";
  std::string all;
  const auto problems = problems_of([&] { parse_matpower(text, "bad.m", 60.0); });
  const auto expect = [&](int line, const std::string& what) {
    for (const Problem& p : problems)
      if (p.where == "bad.m:" + std::to_string(line) && p.sentence().find(what) != std::string::npos) return;
    ADD_FAILURE() << "no problem '" << what << "' on line " << line;
  };
  expect(3, "baseMVA = 0");
  expect(6, "bus 1 appears twice");
  expect(7, "type = 9");
  expect(8, "'NaN'");
  expect(9, "Vm = 0 pu");
  expect(10, "4 columns");
  expect(11, "'1/3'");
  expect(12, "bus_i = 7.5");
  expect(15, "bus 9 is not in mpc.bus");
  expect(16, "mBase = 0 MVA");
  expect(16, "Vg = 0 pu");
  expect(20, "to itself");
  expect(22, "ratio = -1");
  expect(24, "expressions are not evaluated");
  expect(25, "a dc line in service");
  expect(26, "gen is assigned twice");
  expect(27, "'x = 3'");
}

TEST(Matpower, TruncatedFilesAreReported) {
  std::string lines;
  std::istringstream in(kCase);
  int count = 0;
  // The file is complete once the branch matrix has ended; costs and names are not needed.
  const int whole = line_of(kCase, "mpc.gencost") - 1;
  for (std::string line; std::getline(in, line); ++count) {
    if (count >= whole) break;
    EXPECT_FALSE(problems_of([&] { parse_matpower(lines, "cut.m", 60.0); }).empty())
        << "after line " << count;
    lines += line + "\n";
  }
  EXPECT_TRUE(problems_of([&] { parse_matpower(lines, "cut.m", 60.0); }).empty());
  EXPECT_THAT(sentences_of([] { parse_matpower("%{\n", "cut.m", 60.0); }), HasSubstr("block comment"));
  EXPECT_THAT(sentences_of([] { parse_matpower("mpc.a = 'x\n", "cut.m", 60.0); }),
              HasSubstr("not closed at cut.m:1"));
  EXPECT_THAT(sentences_of([] { parse_matpower("mpc.a = ];\n", "cut.m", 60.0); }),
              HasSubstr("without a matching '['"));
}

std::string changed_case(const std::string& from, const std::string& to) {
  std::string text = kCase;
  return text.replace(text.find(from), from.size(), to);
}

TEST(Matpower, RowsOfAnotherLengthAreReported) {
  const std::string longer = changed_case("110, 1, 1.1, 0.9", "110, 1, 1.1, 0.9, 0");
  EXPECT_THAT(sentences_of([&] { parse_matpower(longer, "long.m", 60.0); }),
              HasSubstr("a row of bus with 14 columns at long.m:10 (13 are required): give it 13 columns"));
  const std::string first =
      changed_case("1 80 20 Inf -Inf 1.02 150 1 200 0;", "1 80 20 Inf -Inf 1.02 150 1 200;");
  const auto problems = problems_of([&] { parse_matpower(first, "short.m", 60.0); });
  ASSERT_EQ(problems.size(), 1u) << "rows of the required length must not be refused";
  EXPECT_EQ(problems[0].what, "a row of gen with 9 columns");
}

TEST(Matpower, NumbersOfMoreThanNineDigitsAreReported) {
  const std::string text = changed_case("\t1\t3\t0", "\t12345678901\t3\t0");
  EXPECT_THAT(sentences_of([&] { parse_matpower(text, "digits.m", 60.0); }),
              HasSubstr("it is not a whole number of at most nine digits"));
}

TEST(Matpower, OtherVersionsAreRefused) {
  std::string t = kCase;
  t.replace(t.find("'2'"), 3, "'1'");
  EXPECT_THAT(sentences_of([&] { parse_matpower(t, "one.m", 60.0); }), HasSubstr("not 2 at one.m:3"));
}

TEST(Network, IsReadByExtensionAndChecksTheFrequency) {
  const ScratchFile m("four.m", kCase), raw("case.raw", RawCase().text());
  EXPECT_THAT(sentences_of([&] { read_network(m.path); }), HasSubstr("--frequency-hz"));
  EXPECT_THAT(sentences_of([&] { read_network(m.path, 0.0); }), HasSubstr("0 Hz"));
  expect_same(read_network(m.path, 60.0), read_matpower(m.path, 60.0));
  expect_same(read_network(raw.path), read_raw(raw.path));
  expect_same(read_network(raw.path, 60.0), read_raw(raw.path));
  EXPECT_THAT(sentences_of([&] { read_network(raw.path, 50.0); }), HasSubstr("BASFRQ = 60 Hz"));
}

/// MATPOWER's cases are not part of this repository. The tests look in $SWINGBANK_REFERENCE/networks, then in
/// ../shared/reference/networks. Without the files these tests fail;
/// `.ci/run --without-psse` leaves the suite out.
std::filesystem::path matpower_case(const std::string& name) {
  if (const char* given = std::getenv("SWINGBANK_REFERENCE"))
    return std::filesystem::path(given) / "networks" / name;
  return std::filesystem::path(SWINGBANK_SOURCE) / "../shared/reference/networks" / name;
}
struct Published {
  const char* name;
  std::size_t buses;
  double magnitude, angle;  ///< [pu, degrees]
};
class MatpowerRecords : public ::testing::TestWithParam<Published> {};
TEST_P(MatpowerRecords, SolveToTheirPrintedVoltages) {
  const auto [name, buses, magnitude, angle] = GetParam();
  const auto file = matpower_case(name);
  ASSERT_TRUE(std::filesystem::exists(file))
      << file
      << ": set SWINGBANK_REFERENCE to the folder that holds networks/, or run .ci/run --without-psse";
  const network::Network n = read_matpower(file, 60.0);
  ASSERT_EQ(n.buses.size(), buses);
  network::PowerFlowOptions options;
  options.reactive_limits = false;  // the printed solution ignores them: a unit of case39 exceeds its limit
  const network::PowerFlow flow = network::solve_power_flow(n, options);
  for (std::size_t i = 0; i < buses; ++i) {
    EXPECT_NEAR(std::abs(flow.voltage[i]), n.buses[i].vm, magnitude) << n.buses[i].number;
    EXPECT_NEAR(std::remainder(std::arg(flow.voltage[i]) - n.buses[i].va, 2 * std::numbers::pi) * 180.0 /
                    std::numbers::pi,
                0.0, angle)
        << n.buses[i].number;
  }
}
INSTANTIATE_TEST_SUITE_P(
    Published, MatpowerRecords,
    ::testing::Values(
        // Printed to 8 and 7 significant digits by a program that stops at a mismatch of 1e-8 pu.
        Published{"case39.m", 39, 5.1e-8, 1e-6},
        // Printed to three and two decimals in the IEEE common data format of 1993, one digit of which is
        // off.
        Published{"case14.m", 14, 1.5e-3, 0.02}),
    [](const auto& test) { return std::string(test.param.name).substr(0, 6); });

}  // namespace
}  // namespace swingbank::sim::formats
