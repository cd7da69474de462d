// PSLF .epc: the same grid as from a .raw, features of the format, and errors with their lines.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "sim/formats/matpower.hpp"
#include "sim/formats/pslf_epc.hpp"
#include "sim/network/powerflow.hpp"
#include "tests/sim/formats/flatten.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kNone = R"(-1 "            " 0.00)";
constexpr const char* kOwners = " 1 1.000 0 0.000 0 0.000 0 0.000 0 0.000 0 0.000 0 0.000 0 0.000";

std::string bus_of(int number) {
  const char* name = number == 101 ? "NORTH" : number == 102 ? "EAST" : "SOUTH";
  return fmt::format("{} \"{:<12}\" 138.00", number, name);
}
/// A transmission line, written on two lines of the file.
std::string line(int from, int to, const char* values, int section = 1, const char* second = "0.0 0.0 1.0") {
  return fmt::format(
      "{} {} \"1 \" {} \"  \" : {} 250 0 0 0 0.0 1.0 /\n 1 1 {} 400101 391231 0 1 0 0 0 0 0 {} 0 0\n",
      bus_of(from), bus_of(to), section, values, second, kOwners);
}
/// A transformer, written on four lines of the file. `z`: tbase and impedances; `taps`: tapp, tapfp, tapfs,
/// tapft.
std::string transformer(int from, int to, const std::string& tertiary, const char* z, const char* volts,
                        const char* taps, const char* last = "0.0 0.0 0.0 0.0", const char* angle = "5.0") {
  return fmt::format(
      "{} {} \"1 \" \"  \" : 1 1 {} 0 {} {} 1 1 {} /\n {} {} 0.002 -0.01 0 0 0 0 0.0 1.5 0.5 1.5 0.5 0.00625 {} "
      "400101 391231 0 1 0 0 0 0 /\n {} 0 /\n {} 0 0 0 0 0 0 0.0 0.0 0 0 0 0.0 0.0 0\n",
      bus_of(from), bus_of(to), kNone, kNone, tertiary, z, volts, angle, taps, kOwners, last);
}
std::string unit(int bus, const char* power, const std::string& regulated, const char* second = "0.0 0.0 1.0",
                 const char* zx = "0.3") {
  return fmt::format(
      "{} \"1 \" \"  \" : 1 {} 0.0 1.0 1 1 {} 100.0 0.0 0.0 0.0 {} {} {} 400101 391231 0 0 /\n {} {}\n",
      bus_of(bus), regulated, power, zx, kNone, kNone, second, kOwners);
}

/// The grid of RawCase.
struct EpcCase {
  std::string buses = bus_of(101) + " : 0 1.05 1.05 0.0 1 1 1.1 0.9 400101 391231 0 0 1 0\n" + bus_of(102) +
                      " : 2 1.02 1.02 -0.9 1 1 1.1 0.9 400101 391231 0 0 1 0\n" + bus_of(103) +
                      " : 1 0.99 0.99 -8.7 1 1 1.1 0.9 400101 391231 0 0 1 0\n";
  std::string branches = line(101, 103, "1 0.01 0.12 0.0") + line(102, 103, "1 0.01 0.12 0.0");
  std::string transformers, shunts, svds;
  std::string generators = unit(101, "153.0 200 0 73.0 100 -100", bus_of(101)) +
                           unit(102, "100.0 200 0 -3.0 100 -100", bus_of(102), "0.0 0.0 1.0", "0.25");
  std::string loads = bus_of(103) + " \"1 \" \"  \" : 1 250.0 30.0 0 0 0 0 1 1 400101 391231 0 0 1 0\n";
  std::string others = "area data  [1]\n 1 \"area\" 0 0.0 1.0 0.0 0.0\n", end = "end\n";

  static std::string section(const char* name, const std::string& records) {
    int count = 0;  // the last line of a record has no continuation mark
    std::istringstream in(records);
    for (std::string l; std::getline(in, l);)
      if (!l.ends_with('/')) ++count;
    return fmt::format("{} data  [{:5}]   headings\n", name, count) + records;
  }
  [[nodiscard]] std::string text() const {
    return "# a comment\ntitle\nfirst title\nsecond title\n!\ncomments\nbus data [ 3] \"of no account /\n!\n"
           "solution parameters\ntap    1    tcul\nsbase    100.0    system mva base\n!\n" +
           section("bus", buses) + section("branch", branches) + section("transformer", transformers) +
           section("generator", generators) + section("load", loads) + section("shunt", shunts) +
           section("svd", svds) + others + end;
  }
  [[nodiscard]] network::Network read() const { return parse_epc(text(), "case.epc", {60.0}); }
  [[nodiscard]] std::string faults() const {
    return sentences_of([&] { (void)read(); });
  }
};

TEST(Epc, IsTheSameGridAsItsRaw) {
  RawCase raw;
  EpcCase epc;
  raw.transformers = "101,102,0,'1',1,1,1,0.002,-0.01,2,'',1,1,1.0\n0.01,0.1,100\n0.98,0,5.0\n1.0,0\n";
  epc.transformers = transformer(101, 102, kNone, "100 0.01 0.1 0 0 0 0", "138 138 0", "0.98 1.0 1.0 0.0");
  raw.shunts = "103,'1',1,2.0,20.0\n";
  epc.shunts =
      bus_of(103) + " \"1 \" 0 \"            \" 0.00 \"  \" 0 \"  \" : 1 1 1 0.02 0.2 400101 391231 0 0\n";
  raw.loads = "103,'1',1,1,1,250.0,30.0,2,3,4,-5,1,1,0\n";
  epc.loads = bus_of(103) + " \"1 \" \"  \" : 1 250.0 30.0 2 3 4 5 1 1 400101 391231 0 0 1 0\n";
  expect_same(raw.read(), epc.read());
}

TEST(Epc, IsRecognisedByItsExtensionInAnyCase) {
  const ScratchFile file("CASE.EPC",
                         "\xEF\xBB\xBF" + EpcCase().text().substr(EpcCase().text().find("title")));
  EXPECT_EQ(read_network(file.path, {60.0}).buses.size(), 3U);
  EXPECT_EQ(survey_network(file.path, {60.0}).generator_line.size(), 2U);
}

TEST(Epc, ThreeWindingTransformersEqualThoseOfARaw) {
  RawCase raw;
  EpcCase epc;
  raw.transformers =
      "101,102,103,'1',1,2,1,0.0,0.0,2,'',1,1,1.0\n0.01,0.1,200,0.02,0.3,100,0.015,0.2,200,1.0,0.0\n"
      "1.03,0,5.0\n1.0,0,0.0\n0.99,0,-30.0\n";
  // vnomp 144.9 of 138 kV; tapp 0.98 and tapfp 1.0009523...: 1.05 (0.98 + tapfp - 1) = 1.03
  epc.transformers = transformer(101, 102, bus_of(103), "200 0.01 0.1 0.015 0.2 0.02 0.3", "144.9 138 138",
                                 "0.98 1.0009523809523809 1.0 0.99", "0.0 100.0 0.0 -30.0");
  epc.transformers.replace(epc.transformers.find("0.002 -0.01"), 11, "0.0 0.0");
  epc.transformers.replace(epc.transformers.find("138 5.0"), 7, "138 5.0");
  const network::Network a = raw.read(), b = epc.read();
  ASSERT_EQ(a.branches.size(), b.branches.size());
  for (std::size_t i = 2; i < a.branches.size(); ++i) {
    const network::Branch &x = a.branches[i], &y = b.branches[i];
    EXPECT_EQ(x.from, y.from);
    EXPECT_EQ(x.to, y.to);
    for (const auto& [one, two] : {std::pair(x.r, y.r), {x.x, y.x}, {x.tap, y.tap}, {x.shift, y.shift}})
      EXPECT_NEAR(one, two, 1e-14) << i;
  }
}

TEST(Epc, TransformersUseTheirOwnBaseAndNominalVoltages) {
  EpcCase c;
  c.transformers =
      transformer(101, 102, kNone, "50 0.01 0.1 0 0 0 0", "151.8 131.1 0", "0.98 1.05 1.1 0.0", "0 0 2.0 0");
  const network::Branch b = c.read().branches[2];
  const double t2 = 131.1 / 138 * 1.1;
  EXPECT_NEAR(b.tap, 151.8 / 138 * (0.98 + 1.05 - 1.0) / t2, 1e-14);
  EXPECT_NEAR(b.r, 0.01 * 2 * t2 * t2, 1e-14);
  EXPECT_NEAR(b.x, 0.1 * 2 * t2 * t2, 1e-14);
  EXPECT_NEAR(b.shift, 3.0 * std::numbers::pi / 180, 1e-14);
  EXPECT_NEAR(b.shunt_from.imag(), -0.01 * 0.5 / 1.21, 1e-14);
}

TEST(Epc, SectionsOfALineAreInSeries) {
  EpcCase c;
  c.branches = line(101, 103, "1 0.004 0.05 0.3", 2) + line(102, 103, "1 0.01 0.12 0.0") +
               line(101, 103, "1 0.006 0.07 0.2", 1);
  RawCase raw;
  raw.buses += "104,'MIDDLE',138.0,1,1,1,1,1.0,-4.0,1.1,0.9,1.1,0.9\n";
  raw.branches =
      "101,104,'1',0.006,0.07,0.2,250,250,250,0,0,0,0,1,1,0,1,1\n"
      "104,103,'1',0.004,0.05,0.3,250,250,250,0,0,0,0,1,1,0,1,1\n"
      "102,103,'1',0.01,0.12,0.0,250,250,250,0,0,0,0,1,1,0,1,1\n";
  const network::Network one = c.read();
  ASSERT_EQ(one.branches.size(), 2U);
  const auto a = network::solve_power_flow(one), b = network::solve_power_flow(raw.read());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(std::abs(a.voltage[i] - b.voltage[i]), 1e-12);
  c.branches = line(101, 103, "0 0.004 0.05 0.3", 2) + line(102, 103, "1 0.01 0.12 0.0") +
               line(101, 103, "1 0.006 0.07 0.2", 1);
  EXPECT_FALSE(c.read().branches[0].in_service);
}

TEST(Epc, ShuntsOfABranchAreAtItsEnds) {
  EpcCase c;
  const auto of = [](const char* id, int at, int far) {
    return fmt::format("{} \"{}\" {} \"1 \" 1 \"  \" : 1 1 1 0.0 0.25 400101 391231 0 0\n", bus_of(at), id,
                       bus_of(far));
  };
  c.shunts = of("f ", 101, 103) + of("t ", 103, 102);
  const network::Network n = c.read();
  EXPECT_THAT(n.shunts, IsEmpty());
  EXPECT_EQ(n.branches[0].shunt_from, Complex(0, 0.25));
  EXPECT_EQ(n.branches[0].shunt_to, Complex());
  EXPECT_EQ(n.branches[1].shunt_from, Complex(0, 0.25));  // the record names its second bus, 102
  c.shunts = of("x ", 101, 103) + of("f ", 101, 102);
  EXPECT_THAT(c.faults(), AllOf(HasSubstr("shunt 'x' of a branch"), HasSubstr("no such branch")));
}

TEST(Epc, SvdsStartAtTheirBAndStepOnRequest) {
  EpcCase c;
  const auto svd = [](const char* id, int type) {
    return fmt::format(
        "{} \"{}\" \"  \" : 1 {} {} 1 1 0.0 0.1 0 0 0.02 0 0 400101 391231 0 0 1 1.0 0 0.0 0 0.0 0 0.0 /\n"
        " 2 0.05 1 -0.3 0 0.0\n",
        bus_of(103), id, type, bus_of(102));
  };
  c.svds = svd("1 ", 1) + svd("v ", 2);
  const network::Network n = c.read();
  ASSERT_EQ(n.shunts.size(), 2U);
  EXPECT_EQ(n.shunts[0].id, "SW");
  EXPECT_EQ(n.shunts[1].id, "SWv");
  EXPECT_EQ(n.shunts[0].admittance, Complex(0, 0.1));
  ASSERT_EQ(n.switched.size(), 1U);
  EXPECT_EQ(n.switched[0].regulated, 1);
  EXPECT_THAT(n.switched[0].steps, ElementsAre(-0.3, 0.0, 0.05, 0.1));
  EXPECT_DOUBLE_EQ(n.switched[0].least, 1.0);
  EXPECT_DOUBLE_EQ(n.switched[0].most, 1.04);
  EXPECT_EQ(places(n, "stay at b").size(), 1U);
}

TEST(Epc, GeneratorRegulatesTheVoltageOfItsBus) {
  EpcCase c;
  c.generators = unit(101, "153.0 200 0 73.0 100 -100", bus_of(101)) +
                 unit(102, "100.0 200 0 -3.0 100 -100", bus_of(103), "0.001 0.1 1.02");
  const network::Network n = c.read();
  EXPECT_EQ(n.generators[0].regulated, -1);
  EXPECT_EQ(n.generators[1].regulated, 2);
  EXPECT_DOUBLE_EQ(n.generators[1].vset, 0.99);
  EXPECT_DOUBLE_EQ(n.generators[1].xt, 0.1);
  EXPECT_EQ(places(n, "nominal ratio").size(), 1U);
}

TEST(Epc, ConverterPowerFollowsFromTheVoltages) {
  EpcCase c;
  const network::Network loaded = c.read();
  const auto flow = network::solve_power_flow(loaded);
  c.buses.clear();
  for (int i = 0; i < 3; ++i) {
    const Complex v = flow.voltage[static_cast<std::size_t>(i)];
    c.buses +=
        fmt::format("{} : {} {:.15g} {:.15g} {:.15g} 1 1 1.1 0.9\n", bus_of(101 + i), i == 0 ? 0 : 3 - i,
                    std::abs(v), std::abs(v), std::arg(v) * 180 / std::numbers::pi);
  }
  c.loads.clear();
  c.others += "dc converter data  [1]\n " + bus_of(103) +
              " 9 \"DC          \" 500.0 \"1 \" \"  \" : 1 1 1 1 0 /\n 0 0\n";
  const network::Network n = c.read();
  ASSERT_EQ(n.loads.size(), 1U);
  EXPECT_EQ(n.loads[0].kind, network::LoadKind::device);
  EXPECT_LT(std::abs(n.loads[0].power - Complex(2.5, 0.3)), 1e-9);
}

TEST(Epc, NamesAndCountsIgnoredSections) {
  EpcCase c;
  c.others +=
      "motor data  [ 2]  id\n 103 \"M\" 1.0 : 1 2 3\n 103 \"N\" 1.0 : 1 2 3\ngcd data  [ 0]\n"
      "z table data  [1]\n 3 1 1 0.9 1.1\nowner data  [1]\n 1 \"O\" \"o\" : 0 0\n\n\n";
  EXPECT_THAT(places(c.read(), "not read"), ElementsAre(HasSubstr("motor data, 2 records (case.epc:"),
                                                        HasSubstr("z table data, 1 records (case.epc:")));
}

TEST(Epc, ABusOutOfServiceAndOneOfTypeMinusTwo) {
  EpcCase c;
  c.buses.replace(c.buses.find(": 2 "), 4, ": -2 ");
  c.buses += "104 \"FAR\" 138.0 \" \" 0 : 1 1.0 1.0 0.0 1 1 1.1 0.9 400101 391231 0 0 1 1\n";
  const network::Network n = c.read();
  EXPECT_EQ(n.buses[1].type, network::BusType::generator);
  EXPECT_EQ(n.buses[3].type, network::BusType::isolated);
  EXPECT_EQ(places(n, "st is not 0").size(), 1U);
}

TEST(Epc, ReportsAllErrorsWithTheirLines) {
  EpcCase c;
  c.branches += line(101, 109, "1 0.01 0.12 0.0") + line(101, 102, "2 0.01 x 0.0") +
                line(101, 103, "1 0.01 0.12 0.0") + line(102, 103, "1 0.01 0.12 0.0", 2, "0.0 0.95 1.0");
  c.buses.replace(c.buses.find(": 1 "), 4, ": 3 ");
  c.loads += bus_of(103) + " \"2 \" \"  \" 1 250.0\n" + bus_of(103) + " \"3 \" : 1 \"open\n";
  const std::string text = c.text(), faults = c.faults();
  const auto at = [&](const std::string& part) { return "case.epc:" + std::to_string(line_of(text, part)); };
  EXPECT_THAT(faults,
              HasSubstr("bus 109 is not in the bus section at " + at("101 \"NORTH       \" 138.00 109")));
  EXPECT_THAT(faults, HasSubstr("st = 2 at " + at("101 \"NORTH       \" 138.00 102")));
  EXPECT_THAT(faults, HasSubstr("react = 'x'"));
  EXPECT_THAT(faults, HasSubstr("branch 101-103 circuit '1' appears twice"));
  EXPECT_THAT(faults, HasSubstr("a transformer inside branch 102-103 circuit '1' section 2"));
  EXPECT_THAT(faults, HasSubstr("ty = 3 at " + at("103 \"SOUTH       \" 138.00 :")));
  EXPECT_THAT(faults, HasSubstr("a record without ':'"));
  EXPECT_THAT(faults, HasSubstr("a quote is not closed"));
}

TEST(Epc, ReportsAWrongRecordCount) {
  std::string text = EpcCase().text();
  text.replace(text.find("load data  [    1]"), 18, "load data  [    2]");
  EXPECT_THAT(
      sentences_of([&] { (void)parse_epc(text, "case.epc", {60.0}); }),
      HasSubstr("1 records in the load section at case.epc:" + std::to_string(line_of(text, "load data"))));
}

TEST(Epc, ReportsMissingSectionsInOneSentence) {
  const EpcCase whole;
  EpcCase c;
  c.end.clear();
  EXPECT_THAT(c.faults(), HasSubstr("the file ends without 'end'"));
  EXPECT_THAT(sentences_of([&] { (void)parse_epc(whole.text(), "case.epc", {}); }),
              AllOf(HasSubstr("no frequency at case.epc"), HasSubstr("--frequency-hz")));
  std::string text = whole.text();
  text.replace(text.find("sbase "), 6, "other ");
  EXPECT_THAT(sentences_of([&] { (void)parse_epc(text, "case.epc", {60.0}); }),
              HasSubstr("no sbase above 0 MVA"));
  const auto raw = problems_of([&] { (void)parse_epc(RawCase().text(), "case.epc", {60.0}); });
  EXPECT_LE(raw.size(), 4U);
}

TEST(Epc, RefusesImpedancesInOhms) {
  EpcCase c;
  c.branches.replace(c.branches.find(std::string(kOwners) + " 0 0"), std::string(kOwners).size() + 2,
                     std::string(kOwners) + " 1");
  EXPECT_THAT(c.faults(), HasSubstr("branch 101-103 circuit '1' in ohms"));
}

TEST(Epc, SurveyContinuesAfterErrors) {
  EpcCase c;
  c.loads = "109 \"?\" 138.0 \"1 \" : 1 1 1 0 0 0 0\n";
  const std::string text = c.text();
  const RawSurvey survey = parse_epc_survey(text, "case.epc", {60.0});
  ASSERT_EQ(survey.network.generators.size(), 2U);
  EXPECT_EQ(survey.generator_line[1], line_of(text, "102 \"EAST        \" 138.00 \"1 \" \"  \" : 1"));
  EXPECT_EQ(survey.branch_line[1], line_of(text, "102 \"EAST        \" 138.00 103"));
  ASSERT_EQ(survey.faults.size(), 1U);
  EXPECT_THAT(survey.faults[0].what, HasSubstr("bus 109"));
}

TEST(EpcRepairs, RepeatedLineIsKeptAndDanglingLoadLeftOutOnRequest) {
  EpcCase c;
  c.branches += line(103, 101, "1 0.01 0.24 0.0");
  c.loads += bus_of(177) + " \"1 \" \"  \" : 1 5.0 1.0 0 0 0 0 1 1 400101 391231 0 0 1 0\n";
  RawOptions options{60.0};
  options.repeated = Repeated::kept;
  EXPECT_THAT(sentences_of([&] { (void)parse_epc(c.text(), "case.epc", options); }),
              HasSubstr("bus 177 is not in the bus section"));
  options.drop_refused = true;
  const network::Network n = parse_epc(c.text(), "case.epc", options);
  ASSERT_EQ(n.branches.size(), 3u);
  EXPECT_EQ(n.branches[2].circuit, "R1");
  EXPECT_EQ(n.branches[2].x, 0.24);
  EXPECT_THAT(places(n, "ignored (--drop-refused)"), ElementsAre(HasSubstr("load record at bus 177")));
  options.repeated = Repeated::voltages;  // the file's voltages fit a single line
  EXPECT_FALSE(parse_epc(c.text(), "case.epc", options).branches[2].in_service);
}

}  // namespace
}  // namespace swingbank::sim::formats
