// One unit of a case: read independently of errors elsewhere; written back as .dyr records; inventory.
#include "sim/grid/unit.hpp"

#include <gmock/gmock.h>

#include "sim/grid/inventory.hpp"
#include "sim/network/admittance.hpp"
#include "tests/sim/formats/raw_case.hpp"
#include "tests/sim/network/branch_index.hpp"

namespace swingbank::sim::grid {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kRoundRotor = "8.0 0.03 0.4 0.05 6.175 0.05 1.8 1.7 0.3 0.55 0.25 0.2 0.1 0.8";

class UnitTest : public ::testing::Test {
 protected:
  void write(const std::string& raw, const std::string& dyr) {
    std::ofstream(raw_.path) << raw;
    std::ofstream(dyr_.path) << dyr;
  }
  UnitChoice choice(int bus) const {
    UnitChoice c{.raw = raw_.path, .dyr = dyr_.path};
    c.bus = bus;
    return c;
  }
  static std::string complaints(const UnitChoice& c) {
    return formats::sentences_of([&] { read_unit(c); });
  }
  formats::ScratchFile raw_{"case.raw"}, dyr_{"case.dyr"};
};

TEST_F(UnitTest, IgnoresErrorsOfOtherUnits) {
  formats::RawCase raw;
  raw.generators +=
      "103,'9',x,0,100,-100,1.02,101,50,0,0.4,0,0,1,1\n"
      "999,'1',0,0\n";
  raw.other["two-terminal dc line"] = "'DC',1\n'A'\n'B'\n";
  write(raw.text(), "101 'WHATEVER' 1 1 2 /\n102 'GENROU' 1 " + kRoundRotor +
                        " /\nx 'GENCLS' 1 1 0 /\n102 'IEEEX9' 2 1 /\n103 /\n");
  const Unit unit = read_unit(choice(102));
  EXPECT_EQ(unit.plant.machine.effect->name, "GENROU");
  EXPECT_EQ(unit.plant.mva, 100.0);
  EXPECT_EQ(unit.id, "1");
  EXPECT_EQ(unit.bus_name, "EAST");
  EXPECT_EQ(unit.kv, 138.0);
  EXPECT_EQ(unit.frequency, 60.0);
  EXPECT_THAT(complaints(choice(104)), HasSubstr("no bus 104"));
  EXPECT_THAT(complaints(choice(101)), HasSubstr("unknown model 'WHATEVER' of unit '1' at bus 101"));
}

TEST_F(UnitTest, ReportsItsOwnErrorsWithTheirLine) {
  formats::RawCase raw;
  raw.generators =
      "101,'1',153.0,73.0,100,-100,1.05,0,100,0,0.3,0,0,1,1,100,318,0,1,1\n"
      "102,'1',100.0,-3.0,100,-100,1.02,101,abc,0,0.25,0,0,1,1,100,318,0,1,1\n";
  write(raw.text(), "102 'GENROU' 1 " + kRoundRotor + " /\n102 'SEXS' 1 0.1 10 /\n");
  EXPECT_THAT(complaints(choice(102)), HasSubstr("MBASE = 'abc'"));
  write(formats::RawCase().text(),
        "102 'GENROU' 1 " + kRoundRotor + " /\n102 'SEXS' 1 0.1 10 /\n102 'X9' 1 4 /\n");
  const std::string all = complaints(choice(102));
  EXPECT_THAT(all, HasSubstr("SEXS with 2 parameters"));
  EXPECT_THAT(all, HasSubstr("unknown model 'X9'"));
  EXPECT_THAT(all, HasSubstr("case.dyr:3"));
  EXPECT_THAT(all, HasSubstr("--drop X9"));
}

TEST_F(UnitTest, RecordsAreDroppedAndReplaced) {
  write(formats::RawCase().text(), "101 'OTHER' 1 1 /\n102 'GENROU' 1 " + kRoundRotor +
                                       " /\n102 'X6' 1 0.1 10 100 0.1 -5 5 /\n102 'GOV9' 1 4 /\n");
  UnitChoice c = choice(102);
  c.models.ignore = {"gov9", "OTHER"};
  c.models.map = {{"X6", "sexs"}};
  const Unit six = read_unit(c);
  ASSERT_EQ(six.plant.controls.size(), 1u);
  EXPECT_THAT(six.plant.controls[0].p, Contains(-5.0));  // equal number of parameters: values are taken over
  EXPECT_THAT(six.defaults, ElementsAre());
  EXPECT_THAT(six.notes, Contains(HasSubstr("no record of OTHER")));
  c.models.map = {{"X6", "IEEET1"}};
  const Unit other = read_unit(c);
  EXPECT_THAT(other.defaults, ElementsAre("IEEET1"));
  EXPECT_EQ(other.plant.controls[0].p, other.plant.controls[0].effect->default_parameters());
  c.models.ignore = {"GOV8"};
  EXPECT_THAT(complaints(c), HasSubstr("no model GOV8 to drop"));
  EXPECT_THAT(complaints(c), HasSubstr("the unit has GENROU, GOV9, X6"));
}

/// The voltage behind the plant's STEPUP against that of the network's own branch, either end first.
TEST_F(UnitTest, ATransformerBetweenMachineAndRecordBecomesPartOfThePlant) {
  for (const bool machine_first : {true, false}) {
    formats::RawCase raw;
    raw.branches = "101,103,'1',0.01,0.12,0.0,250,250,250,0,0,0,0,1,1,0,1,1\n";
    raw.transformers = std::string(machine_first ? "102,103" : "103,102") +
                       ",0,'1',1,1,1,0,0,2,'',1,1,1\n0.004,0.1,100\n1.05,0,30.0,0,0,0\n0.98,0\n";
    raw.generators =
        "101,'1',153.0,73.0,100,-100,1.05,0,100,0,0.3,0,0,1,1,100,318,0,1,1\n"
        "102,'1',100.0,-3.0,100,-100,1.02,0,250,0,0.25,0,0,1,1,100,318,0,1,1\n";
    write(raw.text(), "102 'GENROU' 1 " + kRoundRotor + " /\n");
    EXPECT_THAT(read_unit(choice(102)).notes, Contains(HasSubstr("--measured-at 103")));
    EXPECT_EQ(read_unit(choice(102)).plant.transformer.effect, nullptr);
    UnitChoice c = choice(102);
    c.measured_at = 103;
    const plant::Block block = read_unit(c).plant.transformer;
    ASSERT_NE(block.effect, nullptr);
    double r = 0, x = 0, n = 0;
    block.effect->get<double>().transformer.impedance(block.p.data(), r, x, n);
    // The same branch by its admittance matrix: quantities at the machine's side for a voltage and current.
    const network::Network net = formats::read_raw(c.raw);
    const network::Branch& b =
        net.branches[static_cast<std::size_t>(network::branch_index(net, 102, 103, "1"))];
    const Complex y = 1.0 / Complex(b.r, b.x), tap = std::polar(b.tap, b.shift);
    const Complex v_grid(1.01, 0.1), i_machine(0.7, -0.2);  // [pu on 100 MVA]
    Complex v_machine;
    if (machine_first)  // I_m = y (V_m / |t|^2 - V_g / conj(t))
      v_machine = (i_machine / y + v_grid / std::conj(tap)) * std::norm(tap);
    else  // I_m = y (V_m - V_g / t)
      v_machine = i_machine / y + v_grid / tap;
    const double turn = machine_first ? b.shift : -b.shift;
    const Complex ours = v_grid * std::polar(1.0, turn) / n + Complex(r, x) * (100.0 / 250.0) * i_machine;
    EXPECT_NEAR(std::abs(ours - v_machine), 0.0, 1e-12) << machine_first;
    c.measured_at = 101;
    EXPECT_THAT(complaints(c), HasSubstr("no transformers lead from bus 102 to bus 101"));
    EXPECT_THAT(complaints(c), HasSubstr("lead to 103"));
  }
}

/// Unit of 250 MVA at bus 102 behind the given `transformers`, with bus 104 in between if they name it.
formats::RawCase behind(const std::string& transformers, const std::string& buses = "") {
  formats::RawCase raw;
  raw.buses += buses;
  raw.branches = "101,103,'1',0.01,0.12,0.0,250,250,250,0,0,0,0,1,1,0,1,1\n";
  raw.transformers = transformers;
  raw.generators =
      "101,'1',153.0,73.0,100,-100,1.05,0,100,0,0.3,0,0,1,1,100,318,0,1,1\n"
      "102,'1',100.0,-3.0,100,-100,1.02,0,250,0,0.25,0,0,1,1,100,318,0,1,1\n";
  return raw;
}
const std::string kMiddle = "104,'MIDDLE',69.0,1,1,1,1,1.0,0.0\n";

TEST_F(UnitTest, TransformersInSeriesAreJoined) {
  write(behind("102,104,0,'1',1,1,1,0,0,2,'',1\n0.003,0.09,100\n1.05\n1.0\n"
               "103,104,0,'1',1,1,1,0,0,2,'',1\n0.002,0.05,100\n1.02\n1.0\n",
               kMiddle)
            .text(),
        "102 'GENROU' 1 " + kRoundRotor + " /\n");
  UnitChoice c = choice(102);
  c.measured_at = 103;
  const Unit unit = read_unit(c);
  double r = 0, x = 0, n = 0;
  unit.plant.transformer.effect->get<double>().transformer.impedance(unit.plant.transformer.p.data(), r, x,
                                                                     n);
  // First transformer: ratio 1/1.05, impedance times 1.05^2. Second transformer, behind the first: impedance
  // also times 1.05^2, ratio 1.02.
  EXPECT_NEAR(r, 2.5 * 1.1025 * (0.003 + 0.002), 1e-12);
  EXPECT_NEAR(x, 2.5 * 1.1025 * (0.09 + 0.05), 1e-12);
  EXPECT_NEAR(n, 1.02 / 1.05, 1e-12);
  EXPECT_EQ(unit.kv, 138.0);
  EXPECT_THAT(unit.notes, Contains(HasSubstr("in series with")));
}

TEST_F(UnitTest, TransformersInParallelAreJoined_WhenTheirRatiosAgree) {
  const std::string one = "102,103,0,'1',1,1,1,0,0,2,'',1\n0.0,0.2,100\n1.05\n1.0\n";
  write(behind(one + "102,103,0,'2',1,1,1,0,0,2,'',1\n0.0,0.3,100\n1.05\n1.0\n").text(),
        "102 'GENROU' 1 " + kRoundRotor + " /\n");
  UnitChoice c = choice(102);
  c.measured_at = 103;
  const plant::Block block = read_unit(c).plant.transformer;
  double r = 0, x = 0, n = 0;
  block.effect->get<double>().transformer.impedance(block.p.data(), r, x, n);
  EXPECT_NEAR(x, 2.5 * 1.1025 * 0.12, 1e-12);
  EXPECT_NEAR(n, 1 / 1.05, 1e-12);
  write(behind(one + "102,103,0,'2',1,1,1,0,0,2,'',1\n0.0,0.3,100\n1.0\n1.0\n").text(),
        "102 'GENROU' 1 " + kRoundRotor + " /\n");
  EXPECT_THAT(complaints(c), HasSubstr("parallel transformers of different ratios"));
}

TEST_F(UnitTest, WindingsOfAThreeWindingTransformerAreJoined_WhenTheThirdIsUnloaded) {
  const std::string three =
      "102,103,104,'1',1,1,1,0,0,2,'',1\n0,0.10,100,0,0.20,100,0,0.30,100,1.0,0\n1.0\n1.0\n1.0\n";
  write(behind(three, kMiddle).text(), "102 'GENROU' 1 " + kRoundRotor + " /\n");
  EXPECT_THAT(read_unit(choice(102)).notes,
              Contains(HasSubstr("the model ends at bus 102; for records taken at bus 103 or bus 104")));
  UnitChoice c = choice(102);
  c.measured_at = 103;
  const plant::Block block = read_unit(c).plant.transformer;
  double r = 0, x = 0, n = 0;
  block.effect->get<double>().transformer.impedance(block.p.data(), r, x, n);
  EXPECT_NEAR(x, 2.5 * (0.10 + 1e-6), 1e-9);  // the leg of winding 2 is zero
  formats::RawCase loaded = behind(three, kMiddle);
  loaded.loads += "104,'1',1,1,1,5.0,0.0,0,0,0,0,1,1,0\n";
  write(loaded.text(), "102 'GENROU' 1 " + kRoundRotor + " /\n");
  EXPECT_THAT(complaints(c), HasSubstr("winding at bus 104 of 102-103-104"));
  EXPECT_THAT(complaints(c), HasSubstr("--point"));
  c.measured_at = 105;  // the internal number of the star point
  EXPECT_THAT(complaints(c), HasSubstr("no transformers lead from bus 102 to bus 105"));
}

TEST_F(UnitTest, AsksForTheMeasuringPoint_WhenAnotherUnitSharesTheTransformer) {
  formats::RawCase raw = behind("102,103,0,'1',1,1,1,0,0,2,'',1\n0.0,0.1,100\n1.0\n1.0\n");
  raw.generators += "102,'2',50.0,-3.0,100,-100,1.02,0,250,0,0.25,0,0,1,1,100,318,0,1,1\n";
  write(raw.text(), "102 'GENROU' 1 " + kRoundRotor + " /\n");
  EXPECT_THAT(complaints(choice(102)), ::testing::AllOf(HasSubstr("--id"), HasSubstr("--point")));
  UnitChoice c = choice(102);
  c.id = "1";
  c.measured_at = 103;
  EXPECT_THAT(complaints(c),
              ::testing::AllOf(HasSubstr("second generator, '2', at bus 102"), HasSubstr("--point")));
}

TEST_F(UnitTest, IsWrittenAsRecordsThatReadBack) {
  const std::string dyr =
      "102 'GENROU' 1 " + kRoundRotor + " /\n102 'SEXS' 1 0.1 10 100 0.1 -5 5.000000001 /\n";
  write(formats::RawCase().text(), dyr);
  const Unit unit = read_unit(choice(102));
  Problems problems;
  const std::string text = unit_dyr(unit.plant, unit.bus, unit.id, "x.toml", problems);
  EXPECT_TRUE(problems.empty());
  EXPECT_THAT(text, HasSubstr("MBASE = 100 MVA, ZR = 0"));
  write(formats::RawCase().text(), text);
  const Unit back = read_unit(choice(102));
  EXPECT_EQ(back.plant.machine.p, unit.plant.machine.p);
  ASSERT_EQ(back.plant.controls.size(), 1u);
  EXPECT_EQ(back.plant.controls[0].p, unit.plant.controls[0].p);
}

TEST_F(UnitTest, InventoryCountsClassicalMachinesAndTheirIneffectiveRecords) {
  write(formats::RawCase().text(),
        "101 'SEXS' 1 0.1 10 100 0.1 -5 5 /\n101 'GENCLS' 1 3 0 /\n102 'GENROU' 1 " + kRoundRotor +
            " /\n102 'SEXS' 1 0.1 10 100 0.1 -5 5 /\n");
  const Inventory i = take_inventory(raw_.path, dyr_.path);
  ASSERT_EQ(i.units.size(), 2u);
  EXPECT_TRUE(i.units[0].classical);
  EXPECT_EQ(i.units[0].field_records, 1);
  EXPECT_TRUE(i.units[0].covered());
  EXPECT_FALSE(i.units[1].classical);
  EXPECT_THAT(read_unit(choice(101)).notes, Contains(HasSubstr("GENCLS has no field winding")));
}

TEST_F(UnitTest, ReportsADispatchBeyondALimit) {
  const std::string governor = " /\n102 'TGOV1' 1 0.05 0.5 ";
  write(formats::RawCase().text(), "102 'GENROU' 1 " + kRoundRotor + governor + "0.5 0 2 7 0 /\n");
  EXPECT_THAT(read_unit(choice(102)).notes,
              Contains(::testing::AllOf(HasSubstr("is infeasible for this model"),
                                        HasSubstr("its upper limit is 0.5"))));
  write(formats::RawCase().text(), "102 'GENROU' 1 " + kRoundRotor + governor + "2 0 2 7 0 /\n");
  EXPECT_THAT(read_unit(choice(102)).notes, Not(Contains(HasSubstr("is infeasible for this model"))));
}

TEST_F(UnitTest, CompletesShortRecordsOnRequest) {
  write(formats::RawCase().text(),
        "102 'GENROU' 1 " + kRoundRotor + " /\n102 'SEXS' 1 0.1 10 100 0.1 -5 /\n");
  UnitChoice asked = choice(102);
  EXPECT_THAT(formats::sentences_of([&] { read_unit(asked); }), HasSubstr("--complete-records"));
  asked.complete_records = Lacking::zero;
  const Unit unit = read_unit(asked);
  EXPECT_EQ(unit.plant.controls.at(0).p.back(), 0.0);
  EXPECT_THAT(unit.notes, Contains(HasSubstr("has 5 of 6 values: EMAX = 0")));
}

TEST_F(UnitTest, InventoryGroupsUncoveredModels) {
  formats::RawCase raw;
  raw.generators += "103,'1',10.0,0,100,-100,1.02,0,50,0,0.4,0,0,1,1\n103,'2',10.0,0,9,-9,1.0,0,50,0,0.4\n";
  write(raw.text(), "101 'GENROU' 1 " + kRoundRotor + " /\n101 'X9' 1 4 /\n102 'GENROU' 1 " + kRoundRotor +
                        " /\n103 'GENROU' 1 " + kRoundRotor +
                        " /\n103 'X9' 1 4 /\n999 'SEXS' 1 0.1 10 100 0.1 -5 5 /\n"
                        "102 'SEXS' 1 0.1 /\n");
  const Inventory i = take_inventory(raw_.path, dyr_.path);
  ASSERT_EQ(i.units.size(), 4u);
  EXPECT_FALSE(i.units[0].covered());
  EXPECT_THAT(i.units[0].uncovered, ElementsAre("X9"));
  EXPECT_THAT(i.units[1].uncovered, ElementsAre("SEXS"));
  EXPECT_TRUE(i.units[3].models.empty());
  ASSERT_EQ(i.models.size(), 3u);
  EXPECT_EQ(i.models[0].name, "GENROU");
  EXPECT_EQ(i.models[0].records, 3);
  EXPECT_EQ(i.without_generator, 1);
  EXPECT_FALSE(i.units[0].classical);
  for (const auto& m : i.models)
    if (m.name == "X9") {
      EXPECT_EQ(m.uncovered(), 2);
      EXPECT_EQ(m.first_line, 2);
    }
}

}  // namespace
}  // namespace swingbank::sim::grid
