// Static var systems of a .dyr: assignment to switched shunts, their two forms, a remote regulated bus, round
// trip, errors.
#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "sim/grid/grid.hpp"
#include "sim/grid/operating_point.hpp"
#include "sim/reference/reference.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::grid::static_var {
namespace {

using ::testing::HasSubstr;

const std::string kPlants =
    "101 'GENCLS' 1 0.0 0.0 /\n102 'GENROU' 1 8.0 0.03 0.4 0.05 6.175 0.05 1.8 1.7 0.3 0.55 0.25 0.2 0.1 0.8 "
    "/\n";
const std::string kEight = " 0 'A ' 0 '2' 0 '3' 0 '4' 0 '5' 0 '6' 0 '7' 0 '8'\n";
const std::string kRest =
    " 0.18 0.52 0 0.48 1.80 2.00 0.93 6.7 0.91 0.27\n 0.0 0.0 0.0 1.08 0.92 0.0 0.012 0.0 0.0 4.0 40.0 0.45 "
    "-0.45\n 0.012 1.10 0.95 -0.30 0.35 0.0 0.0 0.0 0.0 0.0 0.0 0.0 0.13\n 0.4 37.0 19.0 -38.0 -18.0 0.09 0.47 "
    "2.8 280.0 0.80 1.20 /\n";
std::string record(const std::string& regulated, const std::string& flags = " 0 0") {
  return "103 'SVSMO1T2' " + regulated + flags + kEight + kRest;
}
formats::RawCase with_shunt(const std::string& binit = "30.0") {
  formats::RawCase raw;
  raw.other["switched shunt"] = "103,2,0,1,1.05,0.95,0,100.0,''," + binit + ",2,20.0,2,-15.0\n";
  return raw;
}
Grid load_from(const formats::RawCase& raw, const std::string& dyr) {
  const formats::ScratchFile r("case.raw", raw.text()), d("case.dyr", dyr);
  return load_grid(r.path, d.path, Conventions::psse());
}
bool says(const Grid& grid, const std::string& part) {
  for (const network::Remark& remark : grid.network.remarks)
    for (const std::string& place : remark.places)
      if ((remark.what + ": " + place).find(part) != std::string::npos) return true;
  return false;
}
double parameter_of(const Grid& grid, const char* name) {
  const plant::Block& block = grid.loads.at(0).block;
  return block.p.at(static_cast<std::size_t>(block.effect->parameter_index(name)));
}

TEST(StaticVar, TakesTheSusceptanceOfItsSwitchedShunt) {
  const Grid plain = load_from(with_shunt(), kPlants),
             grid = load_from(with_shunt(), kPlants + record("103"));
  ASSERT_EQ(grid.loads.size(), 1u);
  EXPECT_TRUE(grid.network.shunts.empty());
  const double v = std::abs(grid.flow.voltage[2]);
  EXPECT_NEAR(std::abs(grid.loads[0].consumption - Complex(0.0, -0.3 * v * v)), 0.0, 1e-14);
  for (std::size_t b = 0; b < 3; ++b)
    EXPECT_NEAR(std::abs(grid.flow.voltage[b] - plain.flow.voltage[b]), 0.0, 1e-11);
  EXPECT_EQ(parameter_of(grid, "UVSBmax"), 0.18);
  EXPECT_EQ(parameter_of(grid, "Kiv"), 40.0);
  EXPECT_EQ(parameter_of(grid, "Vrefmax"), 1.2);
  EXPECT_EQ(grid.loads[0].regulated, grid.loads[0].bus);
}

TEST(StaticVar, MayStartAtZero) {
  const Grid grid = load_from(with_shunt("0.0"), kPlants + record("103"));
  ASSERT_EQ(grid.loads.size(), 1u);
  EXPECT_EQ(grid.loads[0].consumption, Complex());
}

network::Event less_load(const Grid& grid) {
  network::Event event;
  event.load_steps.push_back({grid.network.bus_index(102), {-0.3, -0.1}, 1.0, {}});
  return event;
}
double last_voltage(const Grid& grid, int bus) {
  reference::ReferenceOptions options;
  options.t_end = 20.0;
  options.rate = 20.0;
  options.buses = {grid.network.bus_index(bus)};
  const reference::ReferenceRun run = run_reference(grid, less_load(grid), options);
  EXPECT_EQ(run.outcome, Outcome::stable);
  return run.bus_v.back();
}
// The slope in the record is zero, so that the integral restores the regulated voltage exactly.
TEST(StaticVar, RegulatesItsOwnBusOrAnother) {
  const Grid own = load_from(with_shunt(), kPlants + record("103"));
  EXPECT_NEAR(last_voltage(own, 103), std::abs(own.flow.voltage[2]), 2e-5);
  const Grid far = load_from(with_shunt(), kPlants + record("102"));
  ASSERT_EQ(far.loads.at(0).regulated, 1);
  EXPECT_EQ(at_operating_point(far, far.network).loads.at(0).regulated, 1);
  EXPECT_NEAR(last_voltage(far, 102), std::abs(far.flow.voltage[1]), 2e-5);
  EXPECT_GT(std::abs(last_voltage(own, 102) - std::abs(own.flow.voltage[1])), 1e-4);
}

TEST(StaticVar, TheOtherFormNamesTheShunt) {
  const std::string t3 = "103 'SVSMO1T3' '1' 103 1 1" + kEight + kRest;
  const Grid grid = load_from(with_shunt(), kPlants + t3);
  ASSERT_EQ(grid.loads.size(), 1u);
  EXPECT_EQ(parameter_of(grid, "Bmin"), -0.3);
  EXPECT_TRUE(says(grid, "mechanically switched shunts are not switched; Flag2 = 1: the slope is Xc1"));
  const Grid other = load_from(with_shunt(), kPlants + "103 'SVSMO1T3' '7' 103 0 0" + kEight + kRest);
  EXPECT_TRUE(other.loads.empty());
  EXPECT_TRUE(says(other, "models of switched shunts that are missing or out of service are ignored"));
}

TEST(StaticVar, ReportsEveryError) {
  const std::string all = formats::sentences_of(
      [] { load_from(with_shunt(), kPlants + record("103") + record("103") + record("999")); });
  EXPECT_THAT(all, HasSubstr("a second model, SVSMO1T2 at bus 103"));
  EXPECT_THAT(all, HasSubstr("regulates bus 999"));
  const std::string few =
      formats::sentences_of([] { load_from(with_shunt(), kPlants + "103 'SVSMO1T2' 103 0 0 1 2 /\n"); });
  EXPECT_THAT(few, HasSubstr("of 8 switched shunts"));
  std::string text = record("103");  // a text is allowed only in the list of switched shunts
  text.replace(text.find(" 0.18 "), 6, " 'B' ");
  EXPECT_THAT(formats::sentences_of([&] { load_from(with_shunt(), kPlants + text); }),
              HasSubstr("SVSMO1T2 parameter 19 = 'B'"));
  const Grid none = load_from({}, kPlants + record("103"));
  EXPECT_TRUE(says(none, "models of switched shunts that are missing or out of service are ignored"));
}

}  // namespace
}  // namespace swingbank::sim::grid::static_var
