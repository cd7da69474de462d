#include "sim/grid/attach.hpp"

#include <gmock/gmock.h>

#include "tests/sim/grid/far_case.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::grid {
namespace {

std::vector<std::string> said(Grid& grid, const std::string& text) {
  Problems problems;
  attach(grid, text, "--attach " + text, problems);
  std::vector<std::string> list;
  for (const Problem& p : problems.list()) list.push_back(p.sentence());
  return list;
}

TEST(Attach, PutsEffectsIntoTheirSlots) {
  Grid grid = test::two_machine_grid(Conventions::psse());
  EXPECT_TRUE(said(grid, "3:FORCEDOSC:amplitude=0.01,frequency=0.4").empty());
  EXPECT_TRUE(said(grid, "3:sexs").empty());
  EXPECT_TRUE(said(grid, "3:STEPUP:X=0.05").empty());
  EXPECT_TRUE(said(grid, "all:FASTVALVE:drop=0.2").empty());
  const auto& controls = grid.plants[1].controls;
  ASSERT_EQ(controls.size(), 3u);  // in order of Slot, added ones last within their slot
  EXPECT_EQ(controls[0].effect->name, "FORCEDOSC");
  EXPECT_EQ(controls[1].effect->name, "FASTVALVE");
  EXPECT_EQ(controls[2].effect->name, "SEXS");
  EXPECT_EQ(controls[0].p[0], 0.01);
  EXPECT_EQ(controls[0].p[3], 1.0);  // start: default
  EXPECT_EQ(grid.plants[1].transformer.p, (std::vector<double>{0.0, 0.05, 1.0}));
  EXPECT_EQ(grid.plants[0].controls.size(), 1u);
}

TEST(Attach, ReportsErrors) {
  Grid grid = test::two_machine_grid(Conventions::psse());
  (void)said(grid, "3:SEXS");
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"3", "an effect is attached by PLANT:EFFECT"},
      {"3:NOTHING", "unknown effect 'NOTHING'"},
      {"9:FORCEDOSC", "no plant 9 at --attach 9:FORCEDOSC (the plants are 1, 3)"},
      {"3:FORCEDOSC:size=1", "FORCEDOSC has amplitude, frequency"},
      {"3:FORCEDOSC:amplitude=big", "its value is not a number"},
      {"3:FORCEDOSC:amplitude=nan", "its value is not a number"},
      {"3:FORCEDOSC:frequency=-1", "an oscillation has a period"},
      {"3:EXST1", "a second exciter, EXST1, for plant 3"},
      {"3:SEXS", "it already has SEXS"},
      {"3:GENROU", "it is a machine, which cannot be added to a plant"},
      {"3:ZIP", "use --load BUS:EFFECT"}};
  for (const auto& [text, expected] : cases) {
    const auto list = said(grid, text);
    ASSERT_EQ(list.size(), 1u) << text;
    EXPECT_NE(list[0].find(expected), std::string::npos) << list[0];
  }
  EXPECT_EQ(grid.plants[1].controls.size(), 1u);
}

TEST(Attach, RemoteMeasurementsMustExistInTheNetwork) {
  std::string without = far_control::plants({});
  without.erase(without.find("104 'REPCA1'"));
  Grid grid = far_control::load_from(far_control::behind_a_branch(), without);
  Grid other = grid;
  EXPECT_THAT(said(grid, "104:REPCA1:RemoteBus=102,FromBus=102,ToBus=103,Circuit=1"), ::testing::IsEmpty());
  EXPECT_TRUE(grid.plants.at(1).far.has_value());
  EXPECT_THAT(
      said(other, "104:REPCA1:RemoteBus=999,FromBus=102,ToBus=101,Circuit=1"),
      ::testing::ElementsAre(
          ::testing::HasSubstr(
              "bus 999, which REPCA1 of plant 104 measures, is not in service at --attach 104:REPCA1:"),
          ::testing::HasSubstr(
              "branch 102 - 101, circuit 1, which REPCA1 of plant 104 measures, is not in service")));
}

}  // namespace
}  // namespace swingbank::sim::grid
