// Incomplete cases: repairs, the options that request them, and the remarks.
#include <gmock/gmock.h>

#include <cmath>

#include "sim/grid/grid.hpp"
#include "sim/grid/limits.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::grid {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kBoth = "101 'GENCLS' 1 3 0 /\n102 'GENCLS' 1 3 0 /\n";

std::vector<std::string> places(const Grid& grid, const std::string& part) {
  for (const network::Remark& r : grid.network.remarks)
    if (r.what.find(part) != std::string::npos) return r.places;
  return {};
}
Grid make(const formats::RawCase& raw, const std::string& dyr, const CaseOptions& options = {}) {
  return make_grid(formats::parse_raw(raw.text(), "case.raw"), formats::parse_dyr(dyr, "case.dyr"),
                   "case.dyr", Conventions::psse(), options);
}

TEST(FoundCase, GeneratorsWithoutAMachineBecomeNegativeLoadsOnRequest) {
  CaseOptions options;
  options.net_generators = true;
  const Grid whole = make({}, kBoth), grid = make({}, "101 'GENCLS' 1 3 0 /\n", options);
  ASSERT_EQ(grid.plants.size(), 1u);
  EXPECT_EQ(grid.plants[0].name, "101");
  ASSERT_EQ(grid.network.loads.size(), 2u);
  const network::Load& netted = grid.network.loads[1];
  EXPECT_EQ(netted.kind, network::LoadKind::generator);
  EXPECT_EQ(netted.power, -whole.flow.generation[1]);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(grid.flow.voltage[i], whole.flow.voltage[i]);
  EXPECT_FALSE(grid.network.generators[1].in_service);
  EXPECT_THAT(places(grid, "negative loads"), ElementsAre(HasSubstr("'1' at bus 102 100.00 MW")));
}

TEST(FoundCase, RecordsWithoutAGeneratorAreLeftOutWithARemark) {
  formats::RawCase raw;
  raw.generators += "102,'2',10,0,100,-100,1.02,0,100,0,0.3,0,0,1,0\n";
  // An unknown model of a generator out of service is accepted; the remark names the other two records.
  const Grid grid =
      make(raw, kBoth + "102 'STRANGE' 2 1 2 /\n103 'GENCLS' 1 3 0 /\n102 'SEXS' X 0.1 10 100 0.1 0 3 /\n");
  EXPECT_THAT(places(grid, "does not have are ignored"),
              ElementsAre(HasSubstr("GENCLS of '1' at bus 103 (case.dyr:4)"), HasSubstr("case.dyr:5")));
}

TEST(FoundCase, EmptyFieldsOfADyrAreZeroAndCommentsAreIgnored) {
  const Grid grid = make({}, "@! bus, model\n101 'GENCLS' 1 3 0 /\n102, 'GENCLS', 1, 3,, /\n");
  EXPECT_THAT(places(grid, "empty parameters"), ElementsAre("GENCLS parameter 2 (case.dyr:3)"));
}

TEST(FoundCase, NamesASolutionThatDiffersFromTheFile) {
  formats::RawCase raw;
  const Grid solved = make(raw, kBoth);
  EXPECT_THAT(places(solved, "differs from the file's voltages"), ElementsAre(HasSubstr("bus 103 ")));
  CaseOptions options;
  options.start_from_file = true;
  const Grid file = make(raw, kBoth, options);
  EXPECT_EQ(file.flow.voltage[2], std::polar(0.99, -8.7 * std::acos(-1.0) / 180.0));
  EXPECT_THAT(places(file, "imbalances of the file's voltages"), ElementsAre(HasSubstr("bus 103: ")));
  EXPECT_TRUE(places(file, "differs").empty());
}

TEST(FoundCase, BusesAtTheirLimitAreNamed) {
  formats::RawCase raw;
  raw.generators.replace(raw.generators.find("100,-100,1.02"), 3, "5.0");
  const Grid grid = make(raw, kBoth);
  EXPECT_THAT(places(grid, "at a reactive limit"), ElementsAre("bus 102"));
  CaseOptions options;
  options.flow.reactive_limits = false;
  EXPECT_TRUE(places(make(raw, kBoth, options), "at a reactive limit").empty());
}

TEST(FoundCase, ReportsViolatedLimitsTogetherOrMovesThem) {
  // Valve limits of 0.5 pu, but machines that deliver 1.5 and 1.0 pu.
  const std::string dyr =
      kBoth + "101 'TGOV1' 1 0.05 0.5 0.5 0 2 7 0 /\n102 'TGOV1' 1 0.05 0.5 0.5 0 2 7 0 /\n";
  Grid grid = make({}, dyr);
  const auto problems = formats::problems_of([&] { settle_limits(grid, false); });
  EXPECT_GE(problems.size(), 2u);
  std::string all;
  for (const Problem& p : problems) all += p.sentence() + "\n";
  for (const char* part : {"generator 101", "generator 102", "--widen-limits"})
    EXPECT_THAT(all, HasSubstr(part));
  settle_limits(grid, true);
  EXPECT_THAT(places(grid, "limits are widened"),
              ElementsAre(HasSubstr("VMAX of TGOV1 at generator 101: 0.5 becomes"),
                          HasSubstr("VMAX of TGOV1 at generator 102: 0.5 becomes 1")));
  const plant::Block& governor = grid.plants[1].controls[0];
  EXPECT_NEAR(governor.p[static_cast<std::size_t>(governor.effect->parameter_index("VMAX"))], 1.0, 1e-7);
  EXPECT_EQ(governor.p[static_cast<std::size_t>(governor.effect->parameter_index("VMIN"))], 0.0);
}

TEST(FoundCase, CeilingsOfExcitersAreMovedToo) {
  for (const char* exciter :
       {"'SEXS' 1 0.1 10 100 0.1 0 0.3", "'EXST1' 1 0.02 1 -1 1 10 200 0.02 0.3 0 0 0 1",
        "'SCRX' 1 0.1 10 100 0.1 0 0.3 0 0"}) {
    Grid grid =
        make({}, kBoth.substr(kBoth.find('\n') + 1) +
                     "101 'GENROU' 1 8.0 0.03 0.4 0.05 6.5 0 1.8 1.7 0.3 0.55 0.25 0.2 0.05 0.3 /\n101 " +
                     std::string(exciter) + " /\n");
    settle_limits(grid, true);
    EXPECT_THAT(places(grid, "limits are widened"), ElementsAre(HasSubstr("0.3 becomes"))) << exciter;
  }
}

TEST(FoundCase, CompletesOrCutsRecordsOfAnotherLengthOnRequest) {
  const std::string dyr = "101 'GENCLS' 1 3 /\n102 'GENCLS' 1 3 0 7 /\n";
  EXPECT_THAT(formats::sentences_of([&] { make({}, dyr); }), HasSubstr("--complete-records"));
  CaseOptions options;
  options.complete_records = Lacking::zero;
  const Grid grid = make({}, dyr, options);
  EXPECT_EQ(grid.plants[0].machine.p[1], 0.0);
  EXPECT_THAT(places(grid, "missing values at the end of records"),
              ElementsAre(HasSubstr("has 1 of 2 values: D = 0 (")))
      << "the remark must name every completed value";
  EXPECT_THAT(places(grid, "surplus values at the end of records"),
              ElementsAre(HasSubstr("has 3 values instead of 2; ignored: 7 (")));
  options.complete_records = Lacking::standard;
  const Grid standard = make({}, dyr, options);
  const plant::Block& machine = standard.plants[0].machine;
  EXPECT_EQ(machine.p[1], machine.effect->default_parameters()[1]);
}

TEST(FoundCase, ReportsARepeatedErrorInOneSentence) {
  const std::string dyr =
      kBoth + "101 'TGOV1' 1 0.05 0.5 1 /\n102 'TGOV1' 1 0.05 0.4 1 /\n102 'SEXS' 1 0.1 10 /\n";
  const std::string said = formats::sentences_of([&] { make({}, dyr); });
  EXPECT_THAT(said, HasSubstr("TGOV1 with 3 parameters"));
  EXPECT_EQ(said.find("TGOV1 with"), said.rfind("TGOV1 with"));
  EXPECT_THAT(said, ::testing::ContainsRegex("and 1 more, on lines [0-9]+ .*leave these records out"));
  EXPECT_THAT(said, HasSubstr("SEXS with 2 parameters"));
}

TEST(FoundCase, DropsRefusedRecordsOnRequest) {
  const std::string dyr =
      kBoth + "101 'TGOV1' 1 0 0.5 0.5 0 2 7 0 /\n102 'GENCLS' 1 4 0 /\n102 'TGOV1' 1 x 0.5 2 0 2 7 0 /\n";
  EXPECT_THAT(formats::sentences_of([&] { make({}, dyr); }), HasSubstr("--drop-refused"));
  CaseOptions options;
  options.drop_refused = true;
  const Grid grid = make({}, dyr, options);
  EXPECT_THAT(places(grid, "does not accept"), ::testing::SizeIs(3));
  for (const plant::Plant& p : grid.plants) EXPECT_TRUE(p.controls.empty());
  EXPECT_EQ(grid.plants[1].machine.p[0], 3.0);
}

TEST(FoundCase, AcceptsGenrouWithoutQAxisTransientCircuitWithARemark) {
  const Grid grid = make({}, "101 'GENROU' 1 8.0 0.03 0 0.05 6.5 0 1.8 1.7 0.3 1.7 0.25 0.2 0.05 0.3 /\n" +
                                 kBoth.substr(kBoth.find('\n') + 1));
  EXPECT_THAT(places(grid, "the equations interpret differently"), ElementsAre(HasSubstr("T'qo = 0")));
  EXPECT_NO_THROW(plant::operating_point(grid.plants[0], grid.flow.voltage[0], 100.0, grid.conventions));
}

TEST(FoundCase, AcceptsUnusualValuesWithARemark) {
  const Grid grid = make({}, kBoth + "101 'TGOV1' 1 0.05 0.5 2 -1.5 2 7 0 /\n");
  EXPECT_THAT(places(grid, "usual range"),
              ElementsAre("case.dyr:3: VMIN = -1.5 pu (usual range of TGOV1: -1 to 1 pu)"));
  EXPECT_EQ(grid.plants[0].controls[0].p[3], -1.5);
}

TEST(FoundCase, ReportsAnIneffectiveExciter) {
  const std::string sexs = " 'SEXS' 1 0.1 10 100 0.1 0 3 /\n";
  const Grid grid = make({},
                         "101 'GENROU' 1 8.0 0.03 0.4 0.05 6.5 0 1.8 1.7 0.3 0.55 0.25 0.2 0.05 0.3 /\n"
                         "102 'GENCLS' 1 3 0 /\n101" +
                             sexs + "102" + sexs);
  EXPECT_THAT(places(grid, "without field winding"),
              ElementsAre("SEXS of generator 102: GENCLS has no field winding"));
}

TEST(FoundCase, RecognisesTruncatedFiles) {
  const auto said = [](const std::string& dyr) { return formats::sentences_of([&] { make({}, dyr); }); };
  const std::string genrou = "101 'GENROU' 1 8.0 0.03 0.4 0.05 6.5 0 1.8";
  EXPECT_THAT(said(kBoth.substr(kBoth.find('\n') + 1) + genrou),
              ::testing::AllOf(HasSubstr("GENROU with 7 parameters"), HasSubstr("may be truncated there")));
  EXPECT_THAT(said("101 'GENCLS' 1 3 0 /\n102 'GENC"), HasSubstr("a quote is not closed"));
  EXPECT_THAT(said("101 'GENCLS' 1 3 0 /\n101 'SEXS' 1 0.1 10 100 0.1 0 3"),
              ::testing::AllOf(HasSubstr("no machine model for generator '1' at bus 102"),
                               HasSubstr("no '/' ends the last record, on line 2")));
  EXPECT_THAT(said("101 'GENCLS' 1 3 0 /\n"), HasSubstr("all generators before them have a machine model"));
  EXPECT_THAT(said("102 'GENCLS' 1 3 0 /\n"), ::testing::Not(HasSubstr("truncated")));
}

TEST(FoundCase, RefusedMachineIsNotReportedAsMissing) {
  const std::string dyr = "101 'GENCLS' 1 3 0 /\n102 'GENCLS' 1 -3 0 /\n";
  EXPECT_THAT(formats::sentences_of([&] { make({}, dyr); }),
              ::testing::AllOf(HasSubstr("case.dyr:2"), ::testing::Not(HasSubstr("no machine model"))));
  CaseOptions options;
  options.drop_refused = true;
  EXPECT_THAT(formats::sentences_of([&] { make({}, dyr, options); }), HasSubstr("no machine model"));
}

TEST(FoundCase, ReportsUnknownModels) {
  EXPECT_THAT(formats::sentences_of([&] { make({}, kBoth + "101 'EXDC9' 1 1 2 /\n"); }),
              ::testing::AllOf(HasSubstr("unknown model 'EXDC9'"), HasSubstr("Swingbank has no such model"),
                               HasSubstr("swingbank effects --coverage case.dyr"),
                               ::testing::Not(HasSubstr("EXDC2"))));
}

TEST(FoundCase, NamesRecordsByTheirEquipment) {
  EXPECT_THAT(formats::sentences_of([&] { make({}, kBoth + "'DC 1' 'CDC6T' 1 2 /\n"); }),
              ::testing::AllOf(HasSubstr("equipment 'DC 1'"), HasSubstr("--ignore-model CDC6T")));
}

}  // namespace
}  // namespace swingbank::sim::grid
