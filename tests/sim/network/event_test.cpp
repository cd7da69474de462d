#include "sim/network/event.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::network {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

class Segments : public ::testing::Test {
 protected:
  Network network = formats::RawCase{}.read();
};

TEST_F(Segments, NoEventIsOneSegment) {
  const auto s = segments({}, network);
  ASSERT_EQ(s.size(), 1u);
  EXPECT_EQ(s[0].start, 0.0);
  EXPECT_EQ(s[0].topology, Topology{});
}

TEST_F(Segments, FaultTripAndReclosingInOrder) {
  const Complex z(0.01, 0.02);
  const auto s = segments({{{2, 2.0, 2.1, {}}, {0, 1.0, 3.0, z}}, {{1, 2.1, 2.6}}}, network);
  ASSERT_EQ(s.size(), 6u);  // at 2.1 s one switching both clears the fault and trips the line
  EXPECT_THAT(s[0].topology.faults, IsEmpty());
  EXPECT_EQ(s[1].start, 1.0);
  EXPECT_THAT(s[1].topology.faults, ElementsAre(Pair(0, z)));
  EXPECT_EQ(s[2].start, 2.0);
  EXPECT_THAT(s[2].topology.faults, ElementsAre(Pair(0, z), Pair(2, Complex{})));
  EXPECT_EQ(s[3].start, 2.1);
  EXPECT_THAT(s[3].topology.faults, ElementsAre(Pair(0, z)));
  EXPECT_THAT(s[3].topology.open, ElementsAre(1));
  EXPECT_EQ(s[4].start, 2.6);
  EXPECT_THAT(s[4].topology.open, IsEmpty());
  EXPECT_EQ(s[5].start, 3.0);
  EXPECT_EQ(s[5].topology, Topology{});
}

TEST_F(Segments, AFaultFromTheStartIsInTheFirstSegment) {
  const auto s = segments({{{2, 0.0, 0.1, {}}}, {}}, network);
  ASSERT_EQ(s.size(), 2u);
  EXPECT_EQ(s[0].topology.faults.size(), 1u);
}

TEST_F(Segments, ALastingTripHasNoEndAndTouchingFaultsAreOne) {
  EXPECT_EQ(segments({{}, {{0, 1.0, {}}}}, network).size(), 2u);
  EXPECT_EQ(segments({{{2, 1.0, std::numeric_limits<double>::infinity(), {}}}, {}}, network).size(), 2u);
  const auto s = segments({{{2, 1.0, 1.1, {}}, {2, 1.1, 1.2, {}}}, {}}, network);
  ASSERT_EQ(s.size(), 3u);
  EXPECT_EQ(s[2].start, 1.2);
}

TEST_F(Segments, ReportsEveryErrorOfAnEvent) {
  network.branches[1].in_service = false;
  network.buses.push_back({200, "ISOLATED", 1.0, BusType::isolated, 1.0, 0.0});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Event event{{{2, 2.0, 1.9, {}},
                     {0, -1.0, 1.0, {}},
                     {1, 1.0, 3.0, {}},
                     {1, 2.0, 4.0, {0, 1}},
                     {77, 1, 2, {}},
                     {3, 1.0, 2.0, {}},
                     {0, nan, 2.0, {}},
                     {0, 5.0, 6.0, {-1, 0}}},
                    {{0, 2.0, 2.0}, {1, 1.0, {}}, {-1, 1.0, {}}, {0, 3.0, {}}, {0, 4.0, 5.0}}};
  const std::string text = formats::sentences_of([&] { segments(event, network); });
  for (const char* what :
       {"end = 1.9", "start = -1 s", "overlapping faults at event, bus 102", "fault at bus index 77",
        "fault at an isolated bus at event, bus 200", "start = nan", "fault impedance -1 + j0 pu",
        "end = 2 s", "trip of a branch that is out of service at event, branch 102-103 circuit 1",
        "trip of branch index -1", "overlapping trips at event, branch 101-103 circuit 1"})
    EXPECT_THAT(text, HasSubstr(what));
}

}  // namespace
}  // namespace swingbank::sim::network
