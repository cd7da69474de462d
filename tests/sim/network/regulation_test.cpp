// Reactive limits, remote regulation, and the voltages of the file.
#include <gmock/gmock.h>

#include <cmath>

#include "sim/network/powerflow.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::network {
namespace {

/// Slack 1 - line - generator 2 and generator 3 - line - load 4.
Network four_buses(const std::string& second, const std::string& third) {
  formats::RawCase c;
  c.buses =
      "1,'A',100,3,1,1,1,1.0,0\n2,'B',100,2,1,1,1,1.0,0\n3,'C',100,2,1,1,1,1.0,0\n4,'D',100,1,1,1,1,1.0,0\n";
  c.loads = "4,'1',1,1,1,120.0,60.0\n";
  c.generators = "1,'1',0,0,999,-999,1.02\n" + second + third;
  c.branches = "1,4,'1',0.01,0.1\n2,4,'1',0.0,0.1\n3,4,'1',0.0,0.2\n";
  return c.read();
}
const char* const kSecond = "2,'1',40,0,90,-90,1.03,0,100,0,0.3\n";
const char* const kThird = "3,'1',30,0,90,-90,1.01,0,50,0,0.3\n";

TEST(Regulation, BusAtItsLimitReleasesTheVoltage) {
  const Network free = four_buses(kSecond, kThird);
  const PowerFlow wide = solve_power_flow(free);
  EXPECT_TRUE(wide.at_limit.empty());
  EXPECT_NEAR(std::abs(wide.voltage[1]), 1.03, 1e-12);
  ASSERT_GT(wide.generation[1].imag(), 0.2);
  const Network tight = four_buses("2,'1',40,0,20,-90,1.03,0,100,0,0.3\n", kThird);
  const PowerFlow flow = solve_power_flow(tight);
  EXPECT_EQ(flow.at_limit, std::vector<int>{1});
  EXPECT_NEAR(flow.generation[1].imag(), 0.2, 1e-12);
  EXPECT_LT(std::abs(flow.voltage[1]), 1.03);
  EXPECT_NEAR(std::abs(flow.voltage[2]), 1.01, 1e-12);
  PowerFlowOptions off;
  off.reactive_limits = false;
  EXPECT_NEAR(std::abs(solve_power_flow(tight, off).voltage[1]), 1.03, 1e-12);
}

TEST(Regulation, BusReturnsFromItsLimitWithTheVoltage) {
  // Bus 3 first drives bus 2 to its lower limit; once bus 3 reaches its own limit, bus 2 regulates again.
  const Network n = four_buses("2,'1',40,0,90,0,1.0,0,100,0,0.3\n", "3,'1',30,0,20,-90,1.2,0,50,0,0.3\n");
  PowerFlowOptions off;
  off.reactive_limits = false;
  const PowerFlow wide = solve_power_flow(n, off), flow = solve_power_flow(n);
  ASSERT_LT(wide.generation[1].imag(), 0.0);  // beyond its limit before
  EXPECT_EQ(flow.at_limit, std::vector<int>{2});
  EXPECT_NEAR(std::abs(flow.voltage[1]), 1.0, 1e-12);
  EXPECT_GE(flow.generation[1].imag(), 0.0);
}

TEST(Regulation, SeveralGeneratorsShareTheRegulationOfABus) {
  const Network n = four_buses("2,'1',40,0,90,-90,1.0,4,100,0,0.3,0,0,1,1,75\n",
                               "3,'1',30,0,90,-90,1.0,4,50,0,0.3,0,0,1,1,25\n");
  const PowerFlow flow = solve_power_flow(n);
  EXPECT_NEAR(std::abs(flow.voltage[3]), 1.0, 1e-12);
  EXPECT_NEAR(flow.generation[1].imag(), 3.0 * flow.generation[2].imag(), 1e-11);
  // One of the two generators is at its limit, so the other one regulates the bus alone.
  const Network tight = four_buses("2,'1',40,0,5,-90,1.0,4,100,0,0.3,0,0,1,1,75\n",
                                   "3,'1',30,0,90,-90,1.0,4,50,0,0.3,0,0,1,1,25\n");
  const PowerFlow one = solve_power_flow(tight);
  EXPECT_NEAR(std::abs(one.voltage[3]), 1.0, 1e-12);
  EXPECT_NEAR(one.generation[1].imag(), 0.05, 1e-12);
  // Local regulation of a bus takes precedence over remote regulation.
  const Network joined = four_buses(kSecond, "3,'1',30,0,90,-90,1.03,2,50,0,0.3,0,0,1,1,50\n");
  const PowerFlow both = solve_power_flow(joined);
  EXPECT_NEAR(std::abs(both.voltage[1]), 1.03, 1e-12);
  EXPECT_NEAR(both.generation[2].imag(), 0.5 * both.generation[1].imag(), 1e-11);
}

TEST(Regulation, UnitsOfABusStayWithinTheirOwnLimits) {
  const Network n =
      four_buses("2,'1',20,0,10,-90,1.03,0,100,0,0.3\n2,'2',20,0,90,-90,1.03,0,100,0,0.3\n", kThird);
  const PowerFlow flow = solve_power_flow(n), wide = solve_power_flow(four_buses(kSecond, kThird));
  EXPECT_NEAR(flow.generation[1].imag(), 0.1, 1e-12);
  EXPECT_NEAR(flow.generation[1].imag() + flow.generation[2].imag(), wide.generation[1].imag(), 1e-11);
}

TEST(Regulation, FileVoltagesAreKeptWithTheirMismatchAsLoads) {
  Network n = four_buses(kSecond, kThird);
  n.buses[3].vm = 0.97;  // no solution
  n.buses[3].va = -0.05;
  const PowerFlow flow = flow_of_file(n);
  EXPECT_EQ(flow.voltage[3], std::polar(0.97, -0.05));
  ASSERT_EQ(n.loads.size(), 2u);
  EXPECT_EQ(n.loads[1].kind, LoadKind::device);
  ASSERT_EQ(n.remarks.size(), 1u);
  for (std::size_t i = 0; i < n.generators.size(); ++i)
    n.generators[i].p = flow.generation[i].real(), n.generators[i].q = flow.generation[i].imag();
  for (const Complex& left : imbalance_of_file(n)) EXPECT_NEAR(std::abs(left), 0.0, 1e-12);
}

/// A file has five digits of each voltage; across a tie of 1e-6 pu their rounding would cause 10 pu of power.
TEST(Regulation, FileVoltagesAreKeptAcrossATie) {
  Network n = four_buses(kSecond, kThird);
  const PowerFlow solved = solve_power_flow(n);
  for (std::size_t i = 0; i < n.buses.size(); ++i)
    n.buses[i].vm = std::abs(solved.voltage[i]), n.buses[i].va = std::arg(solved.voltage[i]);
  n.buses.push_back(n.buses[3]);  // the load moves behind a tie of ratio 1.05
  n.buses[4].number = 5;
  n.buses[4].vm = n.buses[3].vm / 1.05 + 1e-5;
  for (Load& l : n.loads)
    if (l.bus == 3) l.bus = 4;
  Branch tie{3, 4, "1", 0.0, 1e-6, 0.0};
  tie.tap = 1.05;
  n.branches.push_back(tie);
  const std::size_t loads = n.loads.size();
  const PowerFlow flow = flow_of_file(n);
  EXPECT_NEAR(std::abs(flow.voltage[4]), std::abs(flow.voltage[3]) / 1.05, 1e-12);
  for (std::size_t i = loads; i < n.loads.size(); ++i)
    EXPECT_LT(std::abs(n.loads[i].admittance), 1e-4)
        << n.buses[static_cast<std::size_t>(n.loads[i].bus)].number;
  for (std::size_t i = 0; i < n.generators.size(); ++i)
    EXPECT_NEAR(std::abs(flow.generation[i] - solved.generation[i]), 0.0, 1e-9);
}

}  // namespace
}  // namespace swingbank::sim::network
