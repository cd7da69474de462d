#include "sim/formats/event_text.hpp"

#include <gmock/gmock.h>

#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::HasSubstr;

TEST(EventText, UnitsAndEventTimes) {
  const network::Network network = RawCase{}.read();
  const auto& first = network.generators.front();
  const std::string bus = std::to_string(network.buses[static_cast<std::size_t>(first.bus)].number);
  Problems problems;
  const auto trip = read_generator_trip(bus + "/" + first.id + ":1.5", network, 2.0, "trip", problems);
  EXPECT_EQ(trip.generator, 0);
  EXPECT_EQ(trip.time, 1.5);
  const auto load = read_load_step(bus + ":50:-20:0.5:1", network, 2.0, "load", problems);
  EXPECT_EQ(load.bus, first.bus);
  EXPECT_EQ(load.power, Complex(50, -20) / network.base_mva);
  EXPECT_EQ(load.t_off, 1.0);
  const auto vref = read_setpoint_step(bus + "/" + first.id + ":1:0.02", network, 2.0, true, "v", problems);
  EXPECT_EQ(vref.dVref, 0.02);
  EXPECT_EQ(vref.dPref, 0.0);
  const auto pref = read_setpoint_step(bus + "/" + first.id + ":1:0.02", network, 2.0, false, "p", problems);
  EXPECT_EQ(pref.dPref, 0.02);
  EXPECT_TRUE(problems.empty());
}

TEST(EventText, ATripNamesABranchAWindingOrAWholeTransformer) {
  RawCase c;
  c.buses += "104,'LOW',20.0,1,1,1,1,1.0,0.0\n";
  c.transformers = "101,102,104,'1',1,1,1\n0,0.1,100,0,0.2,100,0,0.15,100\n1.0\n1.0\n1.0\n";
  const network::Network network = c.read();  // lines 101-103, 102-103, then the windings at 101, 102, 104
  const auto opened = [&](const std::string& text) {
    Problems problems;
    std::vector<int> branches;
    for (const auto& trip : read_line_trip(text, network, 2.0, "--trip", problems))
      branches.push_back(trip.branch);
    problems.raise();
    return branches;
  };
  EXPECT_THAT(opened("103:101:1:1"), ::testing::ElementsAre(0));
  EXPECT_THAT(opened("102:101:1:1"), ::testing::ElementsAre(3));
  EXPECT_THAT(opened("104:102:1:1:1.5"), ::testing::ElementsAre(4));
  EXPECT_THAT(opened("101:102:104:1:1"), ::testing::ElementsAre(2, 3, 4));
  EXPECT_THAT(opened("104:101:102:1:1:1.5"), ::testing::ElementsAre(2, 3, 4));
  EXPECT_THAT(sentences_of([&] { opened("101:105:1:1"); }), HasSubstr("no bus 105"));  // the star point
  EXPECT_THAT(sentences_of([&] { opened("101:102:7:1"); }), HasSubstr("no branch 101-102 circuit 7"));
  EXPECT_THAT(sentences_of([&] { opened("101:102:104:7:1:2"); }),
              HasSubstr("no branch 101-102-104 circuit 7"));
  EXPECT_THAT(sentences_of([&] { opened("101:102"); }), HasSubstr("2 fields in '101:102'"));
  EXPECT_EQ(network.branch_text(network.branches[3]), "winding at bus 102 of 101-102-104 circuit 1");
  EXPECT_EQ(network.bus_text(4), "star point of 101-102-104");
}

TEST(EventText, ReportsEveryError) {
  const network::Network network = RawCase{}.read();
  Problems problems;
  (void)read_generator_trip("9999:1", network, 2.0, "--trip-generator", problems);
  (void)read_generator_trip("101", network, 2.0, "--trip-generator", problems);
  (void)read_load_step("9999:x:0:3", network, 2.0, "--load-step", problems);
  (void)read_setpoint_step("9999:nan:1", network, 2.0, true, "--vref-step", problems);
  const std::string text = sentences_of([&] { problems.raise(); });
  for (const char* what : {"no generator 9999 at --trip-generator", "1 fields in '101' at --trip-generator",
                           "no bus 9999 at --load-step", "'x' is not a number at --load-step",
                           "an event at 3 s in a run of 2 s", "'nan' is not a number at --vref-step"})
    EXPECT_THAT(text, HasSubstr(what));
}

}  // namespace
}  // namespace swingbank::sim::formats
