// Load models in a .dyr: assignment to loads, errors; known user-written models.
#include <gmock/gmock.h>

#include "sim/grid/load_choice.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::grid {
namespace {

using ::testing::HasSubstr;

const std::string kPlants =
    "101 'GENCLS' 1 0.0 0.0 /\n102 'GENROU' 1 8.0 0.03 0.4 0.05 6.175 0.05 1.8 1.7 0.3 0.55 0.25 0.2 0.1 0.8 "
    "/\n";
const std::string kMotor =
    "'CIM5BL' 1 1 0.01 0.07 3.5 0.012 0.15 0.02 0.3 1.0 0.05 1.2 0.4 300 0 0.7 0 12 5 1.5 0.9 /\n";
const std::string kPowers = "'IEELBL' 1 0.2 0.3 0.5 0.6 0.4 0 1.5 -1 2 1 0 2 1 0 /\n";

Grid load_from(const formats::RawCase& raw, const std::string& dyr) {
  const formats::ScratchFile r("case.raw", raw.text()), d("case.dyr", dyr);
  return load_grid(r.path, d.path, Conventions::psse());
}
formats::RawCase two_loads() {
  formats::RawCase raw;
  raw.loads = "103,'1',1,1,1,150.0,30.0,0,0,0,0,1,1,0\n103,'2',1,1,1,100.0,10.0,0,0,0,0,1,1,0\n";
  return raw;
}
double parameter_of(const plant::Block& block, const char* name) {
  return block.p.at(static_cast<std::size_t>(block.effect->parameter_index(name)));
}

TEST(LoadRecords, BelongToTheLoadOfTheirId) {
  const Grid grid = load_from(two_loads(), kPlants + "103 " + kMotor);
  ASSERT_EQ(grid.loads.size(), 1u);
  const plant::Consumer& motor = grid.loads[0];
  EXPECT_EQ(motor.name, "103/1");
  EXPECT_EQ(motor.block.effect->name, "CIM5");
  EXPECT_EQ(motor.consumption, Complex(1.5, 0.3));
  EXPECT_EQ(parameter_of(motor.block, "X2"), 0.3);
  EXPECT_EQ(parameter_of(motor.block, "Mbase"), 300.0);
  EXPECT_EQ(parameter_of(motor.block, "E"), 1.5);  // CIM5BL calls it D
  EXPECT_EQ(parameter_of(motor.block, "D"), 1.0);
  EXPECT_EQ(parameter_of(motor.block, "Tnom"), 0.9);
}

TEST(LoadRecords, AStarMeansEveryLoadOfTheBus) {
  const Grid grid =
      load_from(two_loads(), kPlants + "103 'IEELBL' * 0.2 0.3 0.5 0.6 0.4 0 1.5 -1 2 1 0 2 1 0 /\n");
  ASSERT_EQ(grid.loads.size(), 2u);
  EXPECT_EQ(grid.loads[1].name, "103/2");
  EXPECT_EQ(parameter_of(grid.loads[1].block, "a7"), 1.5);
  EXPECT_EQ(parameter_of(grid.loads[1].block, "n2"), 1.0);
}

TEST(LoadRecords, ReportsEveryError) {
  const std::string all = formats::sentences_of([] {
    load_from({},
              kPlants + "103 " + kMotor + "103 " + kPowers + "999 " + kPowers + "103 'CIM5BL' 1 1 2 3 /\n");
  });
  EXPECT_THAT(all, HasSubstr("a second model, IEELBL for load '1' at bus 103"));
  EXPECT_THAT(all, HasSubstr("it already has CIM5BL"));
  EXPECT_THAT(all, HasSubstr("IEELBL for load '1' at bus 999"));
  EXPECT_THAT(all, HasSubstr("CIM5BL with 3 parameters"));
  EXPECT_THAT(all, HasSubstr("it takes 20: IT Ra Xa"));
  const std::string relay = formats::sentences_of([] {
    load_from(
        {}, kPlants + "103 'CIM5BL' 1 1 0.01 0.07 3.5 0.012 0.15 0 0 1 0 1.2 0 300 0 0.7 0.65 12 5 2 0 /\n");
  });
  EXPECT_THAT(relay, HasSubstr("VI = 0.65 pu"));
  EXPECT_THAT(relay, HasSubstr("case.dyr:3"));
}

TEST(LoadRecords, KeepTheirModels_WhenOtherLoadsAreComposed) {
  Grid grid = load_from(two_loads(), kPlants + "103 " + kMotor);
  Problems problems;
  loads_as_composed(grid, problems);
  problems.raise();
  ASSERT_EQ(grid.loads.size(), 2u);
  EXPECT_EQ(grid.loads[0].block.effect->name, "CIM5");
  EXPECT_EQ(grid.loads[1].block.effect->name, "ZIP");
}

/// Two loads at bus 103: one of area 1, zone 2, owner 4, one of area 3, zone 2, owner 5.
formats::RawCase scattered_loads() {
  formats::RawCase raw;
  raw.loads = "103,'1',1,1,2,150.0,30.0,0,0,0,0,4,1,0\n103,'2',1,3,2,100.0,10.0,0,0,0,0,5,1,0\n";
  return raw;
}
std::string powers(const std::string& ending, const std::string& id, double a1) {
  return "'IEEL" + ending + "' " + id + " " + std::to_string(a1) +
         " 0.3 0.5 0.6 0.4 0 1.5 -1 2 1 0 2 1 0 /\n";
}
/// a1 of each load's model; -1 without a model.
std::vector<double> first_states(const Grid& grid) {
  std::vector<double> list(grid.network.loads.size(), -1.0);
  for (const plant::Consumer& c : grid.loads)
    list[static_cast<std::size_t>(c.load)] = parameter_of(c.block, "a1");
  return list;
}

TEST(LoadRecords, ReachTheLoadsOfAnAreaZoneOwnerOrAll) {
  using Firsts = std::vector<double>;
  const auto of = [](const std::string& records) {
    return first_states(load_from(scattered_loads(), kPlants + records));
  };
  EXPECT_EQ(of("3 " + powers("AR", "*", 0.25)), (Firsts{-1, 0.25}));
  EXPECT_EQ(of("2 " + powers("ZN", "*", 0.25)), (Firsts{0.25, 0.25}));
  EXPECT_EQ(of("2 " + powers("ZN", "1", 0.25)), (Firsts{0.25, -1}));
  EXPECT_EQ(of("4 " + powers("OW", "*", 0.25)), (Firsts{0.25, -1}));
  EXPECT_EQ(of("0 " + powers("AL", "*", 0.25)), (Firsts{0.25, 0.25}));
  // the more specific record applies, in any order
  const std::string all = "0 " + powers("AL", "*", 0.25), area = "3 " + powers("AR", "*", 0.5),
                    owner = "5 " + powers("OW", "*", 0.75), own = "103 " + powers("BL", "2", 1.0);
  EXPECT_EQ(of(all + area), (Firsts{0.25, 0.5}));
  EXPECT_EQ(of(owner + area + all), (Firsts{0.25, 0.75}));
  EXPECT_EQ(of(own + all + owner), (Firsts{0.25, 1.0}));
  EXPECT_THAT(formats::sentences_of([&] { of(area + area); }),
              HasSubstr("a second model, IEELAR for load '*' in area 3"));
}

TEST(LoadRecords, AreasOfLoadsDefaultToThoseOfTheirBuses) {
  formats::RawCase raw;
  raw.buses =
      "101,'N',138.0,3,1,1,1,1.05,0.0\n102,'E',138.0,2,1,1,1,1.02,-0.9\n103,'S',138.0,1,7,8,9,0.99,-8.7\n";
  raw.loads = "103,'1',1,,,150.0,30.0\n103,'2',1,3,,100.0,10.0\n";
  const network::Network n = raw.read();
  EXPECT_EQ(n.loads[0].area, 7);
  EXPECT_EQ(n.loads[0].zone, 8);
  EXPECT_EQ(n.loads[0].owner, 9);
  EXPECT_EQ(n.loads[1].area, 3);
  EXPECT_EQ(n.loads[1].zone, 8);
}

TEST(LoadRecords, MotorWithItsLoadTorque) {
  const Grid grid =
      load_from({}, kPlants +
                        "103 'CIM6BL' 1 1 0.01 0.07 3.5 0.012 0.15 0 0 1 0 1.2 0 300 0 0.7 0 12 5 0.5 "
                        "0.2 0.1 1.5 0.3 0.9 /\n");
  ASSERT_EQ(grid.loads.size(), 1u);
  const plant::Block& motor = grid.loads[0].block;
  EXPECT_EQ(motor.effect->name, "CIM6");
  const double torque[] = {0.5, 0.2, 0.1, 1.5, 0.3, 0.9};
  int i = 0;
  for (const char* name : {"A", "B", "D", "E", "C0", "Tnom"})
    EXPECT_EQ(parameter_of(motor, name), torque[i++]);
}

TEST(LoadRecords, FrequencyDependentLoadKeepsTheCompositionOfTheRaw) {
  formats::RawCase raw;
  raw.loads = "103,'1',1,1,1,150.0,0.0,60.0,-20.0,40.0,-10.0,1,1,0\n";
  Grid grid = load_from(raw, kPlants + "103 'LDFRBL' * 1.5 -1 0.5 0.25 /\n");
  ASSERT_EQ(grid.loads.size(), 1u);
  const plant::Block& block = grid.loads[0].block;
  EXPECT_EQ(block.effect->name, "LDFR");
  EXPECT_EQ(parameter_of(block, "s"), 0.25);
  const double v = std::abs(grid.flow.voltage[2]), p = 1.5 + 0.6 * v + 0.4 * v * v;
  const double q = -0.2 * v + 0.1 * v * v;  // YQ is a susceptance
  EXPECT_NEAR(parameter_of(block, "Pp"), 1.5 / p, 1e-15);
  EXPECT_NEAR(parameter_of(block, "Pi"), 0.6 * v / p, 1e-15);
  EXPECT_EQ(parameter_of(block, "Qp"), 0.0);
  EXPECT_NEAR(parameter_of(block, "Qi"), -0.2 * v / q, 1e-14);
}

TEST(LoadRecords, AStarIsEveryLoadWithoutAModel) {
  Grid grid = load_from(two_loads(), kPlants + "103 " + kMotor);
  Problems problems;
  choose_load(grid, "*:ZIP:Pi=1,Qp=0.5", "--load", problems);
  EXPECT_TRUE(problems.empty());
  ASSERT_EQ(grid.loads.size(), 2u);
  EXPECT_EQ(grid.loads[0].block.effect->name, "CIM5");
  EXPECT_EQ(grid.loads[1].block.effect->name, "ZIP");
  EXPECT_EQ(parameter_of(grid.loads[1].block, "Pi"), 1.0);
  choose_load(grid, "*:ZIP", "--load", problems);
  EXPECT_THAT(formats::sentences_of([&] { problems.raise(); }),
              HasSubstr("no load without a model at --load"));
}

/// RT and XT of a generator's record are the plant's step-up transformer.
TEST(LoadRecords, StepUpTransformersAreInTheRaw) {
  formats::RawCase raw;
  raw.generators =
      "101,'1',153.0,73.0,100,-100,1.05,0,100,0,0.3,0,0,1,1\n"
      "102,'1',100.0,-3.0,100,-100,1.02,0,125,0,0.25,0.002,0.12,1,1\n";
  Grid grid = load_from(raw, kPlants);
  EXPECT_EQ(grid.plants[0].transformer.effect, nullptr);
  const plant::Block& step_up = grid.plants[1].transformer;
  ASSERT_NE(step_up.effect, nullptr);
  EXPECT_EQ(parameter_of(step_up, "R"), 0.002);
  EXPECT_EQ(parameter_of(step_up, "X"), 0.12);
  EXPECT_EQ(parameter_of(step_up, "ratio"), 1.0);
}

/// PSS/E up to 33 writes GENTPJ as a user-written model, from 34 on as GENTPJ1.
TEST(LoadRecords, KnownUserWrittenModelsAreReadAsEffects) {
  const std::string infinite = "101 'GENCLS' 1 0.0 0.0 /\n102 ",
                    values = " 8.0 0.03 0.4 0.05 6.175 0.05 1.8 1.7 0.3 0.55 0.25 0.26 0.2 0.1 0.4 0.08 /\n";
  for (const std::string& record :
       {"'GENTPJU1' 1" + values, "'GENTPJ1' 1" + values, "'USRMDL' 1 'GENTPJU1' 1 1 0 16 6 1" + values}) {
    const Grid grid = load_from({}, infinite + record);
    const plant::Block& machine = grid.plants[1].machine;
    EXPECT_EQ(machine.effect->name, "GENTPJ");
    EXPECT_EQ(parameter_of(machine, "Tdop"), 8.0);
    EXPECT_EQ(parameter_of(machine, "Xqpp"), 0.26);
    EXPECT_EQ(parameter_of(machine, "Kis"), 0.08);
  }
  EXPECT_THAT(
      formats::sentences_of([&] { load_from({}, infinite + "'USRMDL' 1 'GENTPJU1' 1 1 0 15 6 1" + values); }),
      HasSubstr("GENTPJU1 with 22 parameters"));
}

/// 'GENTPJU1' is GENTPJ1, 'GENROUU1' GENROU: the rule applies to every model, including mapped ones.
TEST(LoadRecords, NamesOfUserWrittenModelsFollowOneRule) {
  const std::string infinite = "101 'GENCLS' 1 0.0 0.0 /\n102 ",
                    values = " 8.0 0.03 0.4 0.05 6.175 0.05 1.8 1.7 0.3 0.55 0.25 0.2 0.1 0.8 /\n";
  for (const std::string& record : {"'USRMDL' 1 'GENROUU1' 1 1 0 14 6 1" + values,
                                    "'USRMDL' 1 'GENROUU' 1 1 0 14 6 1" + values, "'GENROUU1' 1" + values}) {
    const Grid grid = load_from({}, infinite + record);
    EXPECT_EQ(grid.plants[1].machine.effect->name, "GENROU");
    EXPECT_EQ(parameter_of(grid.plants[1].machine, "Tdop"), 8.0);
  }
}

}  // namespace
}  // namespace swingbank::sim::grid
